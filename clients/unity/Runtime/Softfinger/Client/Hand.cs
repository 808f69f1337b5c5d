using System;
using System.Collections.Generic;

namespace Softfinger
{
    /// <summary>
    /// A joint of a hand as WebXR has it: in a right-handed space, y up, whose origin is the scene's (x_W = -z,
    /// y_W = -x, z_W = y); -z along the bone, away from the wrist, -y out of the palm's side.
    /// https://www.w3.org/TR/webxr-hand-input-1/
    /// </summary>
    public struct HandJoint
    {
        public Pose Pose;

        /// <summary>0 to 0.1.</summary>
        public float Radius_m;
    }

    /// <summary>A hand that a headset sees, for fingers whose tracker is webxr.</summary>
    public sealed class Hand
    {
        /// <summary>In the order of XRHandJoint: wrist, four of the thumb, five each of index, middle, ring and pinky finger.</summary>
        public const int JointCount = 25;

        public bool Left { get; set; }

        /// <summary>Else it is out of sight, and Joints do not count.</summary>
        public bool Tracked { get; set; }

        /// <summary>When it was seen, on any clock that does not go back; at least 0.</summary>
        public double Time_s { get; set; }

        public HandJoint[] Joints { get; } = new HandJoint[JointCount];

        const uint Magic = 0x58484653;  // "SFHX"
        const double LongestTime_s = 100.0 * 366 * 86400;
        const double Farthest_m = 10;

        /// <summary>As softfinger's viewer/hand_message.hpp reads it. Throws InputError for what it would refuse.</summary>
        internal byte[] ToBytes()
        {
            if (!(Time_s >= 0 && Time_s <= LongestTime_s)) throw new InputError("a hand: its time has to be from 0 to 100 years");
            var bytes = new List<byte>(816);
            bytes.AddRange(BitConverter.GetBytes(Magic));
            bytes.AddRange(BitConverter.GetBytes((Tracked ? 1u : 0u) | (Left ? 2u : 0u)));
            bytes.AddRange(BitConverter.GetBytes(1e3 * Time_s));
            if (!Tracked) return bytes.ToArray();
            for (int i = 0; i < JointCount; ++i)
            {
                Pose pose = Joints[i].Pose;
                if (!pose.IsWithin(Farthest_m)) throw new InputError($"a hand: joint {i} has to be within {Farthest_m} m, its quaternion of length 1");
                if (!(Joints[i].Radius_m >= 0 && Joints[i].Radius_m <= 0.1f)) throw new InputError($"a hand: the radius of joint {i} has to be from 0 to 0.1 m");
                foreach (double part in new[] { pose.X_m, pose.Y_m, pose.Z_m, pose.Qx, pose.Qy, pose.Qz, pose.Qw, Joints[i].Radius_m })
                {
                    bytes.AddRange(BitConverter.GetBytes((float)part));
                }
            }
            return bytes.ToArray();
        }
    }
}
