using UnityEngine;

namespace Softfinger.Unity
{
    /// <summary>
    /// A finger whose tracker is page follows this transform: its origin the middle of the distal phalanx, z out of the
    /// fingertip, y out of the nail. Disabled, its tracking is lost 200 ms later, and the device retracts.
    /// </summary>
    [AddComponentMenu("softfinger/Tracked Finger")]
    public sealed class TrackedFinger : ConnectedBehaviour
    {
        const double Farthest_m = 1;

        [SerializeField, Tooltip("Empty: the first of the scene")]
        string finger = "";

        public string Finger
        {
            get => finger;
            set => finger = value;
        }

        void Update()
        {
            if (Connection == null) return;
            int index = Connection.FingerNamed(finger);
            if (index < 0 || !Connection.Scene.Fingers[index].MovedHere) return;
            Pose pose = Frames.PoseIn(Connection.transform, transform);
            // So far away nothing is touched, and softfinger would refuse it.
            if (System.Math.Abs(pose.X_m) < Farthest_m && System.Math.Abs(pose.Y_m) < Farthest_m && System.Math.Abs(pose.Z_m) < Farthest_m)
            {
                Connection.SendPose(index, pose);
            }
        }
    }
}
