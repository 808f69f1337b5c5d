using System;

namespace Softfinger
{
    /// <summary>
    /// A rigid transform: position in m, unit quaternion. Frames: W world, right-handed, z up; F finger, its origin
    /// the centre of the distal phalanx, x out of the fingertip, y to the left seen from above the nail, z out of the
    /// nail; Ft the tracked finger; O an object. X_WF is the pose of F in W.
    /// </summary>
    public struct Pose
    {
        public double X_m, Y_m, Z_m;
        public double Qw, Qx, Qy, Qz;

        public Pose(double x_m, double y_m, double z_m, double qw = 1, double qx = 0, double qy = 0, double qz = 0)
        {
            X_m = x_m;
            Y_m = y_m;
            Z_m = z_m;
            Qw = qw;
            Qx = qx;
            Qy = qy;
            Qz = qz;
        }

        public static Pose Identity => new Pose(0, 0, 0);

        /// <summary>Whether positions are within so many m in each coordinate, and the quaternion's length is 1 within 1 %.</summary>
        internal bool IsWithin(double most_m)
        {
            double length = Math.Sqrt(Qw * Qw + Qx * Qx + Qy * Qy + Qz * Qz);
            // Written so that what is not a number is refused.
            return Math.Abs(X_m) <= most_m && Math.Abs(Y_m) <= most_m && Math.Abs(Z_m) <= most_m &&
                Math.Abs(length - 1) <= 0.01;
        }
    }
}
