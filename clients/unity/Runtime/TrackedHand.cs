using UnityEngine;

namespace Softfinger.Unity
{
    /// <summary>
    /// Fingers whose tracker is webxr follow these joints, as Unity's XR Hands have them: z along the bone, away from the wrist, y
    /// out of the back of the hand. Disabled, or not Tracked, the fingers' tracking is lost, and their devices retract.
    /// </summary>
    [AddComponentMenu("softfinger/Tracked Hand")]
    public sealed class TrackedHand : ConnectedBehaviour
    {
        [SerializeField]
        bool left = false;

        [SerializeField, Tooltip("m, from a joint to the skin")]
        float radius_m = 0.008f;

        [SerializeField, Tooltip("25: wrist, four of the thumb, five each of index, middle, ring and little finger; no palm")]
        Transform[] joints = new Transform[Hand.JointCount];

        /// <summary>What sees the hand says so in every frame.</summary>
        public bool Tracked { get; set; } = true;

        public bool Left
        {
            get => left;
            set => left = value;
        }

        public Transform[] Joints => joints;

        void Update()
        {
            if (Connection == null) return;
            // One of its own for each frame: the one before may not have gone yet.
            var hand = new Hand { Left = left, Tracked = Tracked, Time_s = Time.realtimeSinceStartup };
            for (int i = 0; i < Hand.JointCount && hand.Tracked; ++i)
            {
                if (i >= joints.Length || joints[i] == null)
                {
                    hand.Tracked = false;
                    break;
                }
                hand.Joints[i] = new HandJoint { Pose = Frames.XrPoseIn(Connection.transform, joints[i]), Radius_m = radius_m };
            }
            Connection.SendHand(hand);
        }
    }
}
