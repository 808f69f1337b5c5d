using UnityEngine;

namespace Softfinger.Unity
{
    /// <summary>
    /// From softfinger's frames to Unity's and back, as sf_pose_to_unity does: x_U = -y_W, y_U = z_W, z_U = x_W. Axes of
    /// bodies turn with those of the world: F's tip is along z, its nail along y. Front sides are counter-clockwise there and
    /// clockwise here.
    /// </summary>
    public static class Frames
    {
        public static Vector3 ToUnity(double x, double y, double z) => new Vector3((float)-y, (float)z, (float)x);
        public static Vector3 PositionToUnity(Pose pose) => ToUnity(pose.X_m, pose.Y_m, pose.Z_m);

        public static Quaternion RotationToUnity(Pose pose) =>
            new Quaternion((float)pose.Qy, (float)-pose.Qz, (float)-pose.Qx, (float)pose.Qw);

        public static Pose FromUnity(Vector3 p, Quaternion q) => new Pose(p.z, -p.x, p.y, q.w, -q.z, q.x, -q.y);

        /// <summary>Places a transform in its parent.</summary>
        public static void Place(Transform transform, Pose pose)
        {
            transform.localPosition = PositionToUnity(pose);
            transform.localRotation = RotationToUnity(pose);
        }

        /// <summary>Where a transform is in the scene whose origin is `origin`.</summary>
        public static Pose PoseIn(Transform origin, Transform transform) => FromUnity(
            origin.InverseTransformPoint(transform.position), Quaternion.Inverse(origin.rotation) * transform.rotation);

        /// <summary>
        /// The same as WebXR has it, right-handed, -z along the bone. Unity's XR Hands turn OpenXR's z about, this turns it back.
        /// </summary>
        public static Pose XrPoseIn(Transform origin, Transform transform)
        {
            Vector3 p = origin.InverseTransformPoint(transform.position);
            Quaternion q = Quaternion.Inverse(origin.rotation) * transform.rotation;
            return new Pose(p.x, p.y, -p.z, q.w, -q.x, -q.y, q.z);
        }

        /// <summary>Triangles seen from the same side.</summary>
        public static int[] TrianglesToUnity(int[] corners)
        {
            var swapped = (int[])corners.Clone();
            for (int i = 0; i < swapped.Length; i += 3)
            {
                swapped[i + 1] = corners[i + 2];
                swapped[i + 2] = corners[i + 1];
            }
            return swapped;
        }

        /// <summary>x, y, z of each sample into as many vertices.</summary>
        public static void ToUnity(float[] xyz, Vector3[] vertices)
        {
            for (int i = 0; i < vertices.Length; ++i) vertices[i] = new Vector3(-xyz[3 * i + 1], xyz[3 * i + 2], xyz[3 * i]);
        }
    }
}
