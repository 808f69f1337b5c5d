namespace Softfinger
{
    /// <summary>
    /// A pose as Unity has it: left-handed, y up, m; x_U = -y_W, y_U = z_W, z_U = x_W. Axes of bodies turn with those
    /// of the world: F's tip is along z. The library's own conversion.
    /// </summary>
    public struct UnityPose
    {
        public double X_m, Y_m, Z_m;
        public double Qx, Qy, Qz, Qw;

        public static unsafe UnityPose From(Pose pose)
        {
            Native.Need();
            Native.Pose from = NativePose.Of(pose);
            var to = new Native.UnityPose { size = (uint)sizeof(Native.UnityPose) };
            Native.Check(Native.sf_pose_to_unity(&from, &to), "a pose: its quaternion has to be of length 1");
            return new UnityPose
            {
                X_m = to.position_m[0],
                Y_m = to.position_m[1],
                Z_m = to.position_m[2],
                Qx = to.quaternion_xyzw[0],
                Qy = to.quaternion_xyzw[1],
                Qz = to.quaternion_xyzw[2],
                Qw = to.quaternion_xyzw[3],
            };
        }

        public unsafe Pose ToPose()
        {
            Native.Need();
            var from = new Native.UnityPose { size = (uint)sizeof(Native.UnityPose) };
            from.position_m[0] = X_m;
            from.position_m[1] = Y_m;
            from.position_m[2] = Z_m;
            from.quaternion_xyzw[0] = Qx;
            from.quaternion_xyzw[1] = Qy;
            from.quaternion_xyzw[2] = Qz;
            from.quaternion_xyzw[3] = Qw;
            Native.Pose to = NativePose.Empty;
            Native.Check(Native.sf_pose_from_unity(&from, &to), "a pose of Unity: its quaternion has to be of length 1");
            return NativePose.Read(to);
        }
    }

    internal static unsafe class NativePose
    {
        public static Native.Pose Empty => new Native.Pose { size = (uint)sizeof(Native.Pose) };

        public static Native.Pose Of(Pose pose)
        {
            Native.Pose native = Empty;
            native.position_m[0] = pose.X_m;
            native.position_m[1] = pose.Y_m;
            native.position_m[2] = pose.Z_m;
            native.quaternion_wxyz[0] = pose.Qw;
            native.quaternion_wxyz[1] = pose.Qx;
            native.quaternion_wxyz[2] = pose.Qy;
            native.quaternion_wxyz[3] = pose.Qz;
            return native;
        }

        public static Pose Read(Native.Pose native) => new Pose(
            native.position_m[0], native.position_m[1], native.position_m[2],
            native.quaternion_wxyz[0], native.quaternion_wxyz[1], native.quaternion_wxyz[2], native.quaternion_wxyz[3]);
    }
}
