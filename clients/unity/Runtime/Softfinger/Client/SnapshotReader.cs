using System;
using System.Text;

namespace Softfinger
{
    /// <summary>Reads a snapshot as softfinger's viewer/snapshot_message.hpp lays it out. Nothing is taken from outside it.</summary>
    internal sealed class SnapshotReader
    {
        const uint Magic = 0x41534653;  // "SFSA"
        const int PoseBytes = 28;
        const int StateBytes = 16;
        const float Degree = (float)(Math.PI / 180);

        readonly byte[] bytes;
        readonly int size;
        readonly Scene scene;
        int at;

        SnapshotReader(byte[] bytes, int size, Scene scene)
        {
            this.bytes = bytes;
            this.size = size;
            this.scene = scene;
        }

        /// <summary>Of the first `size` bytes. Null: it is of another scene than this.</summary>
        public static Snapshot Read(byte[] bytes, int size, Scene scene) => new SnapshotReader(bytes, size, scene).Read();

        Snapshot Read()
        {
            if (U32() != Magic) throw new OperationError("a snapshot does not begin with SFSA: take this client and the program from one version of softfinger");
            var snapshot = new Snapshot { Generation = U32() };
            if (snapshot.Generation != unchecked((uint)scene.Generation)) return null;
            snapshot.Step = U32();
            uint flags = U32();
            snapshot.Paused = (flags & 1) != 0;
            snapshot.Finished = (flags & 2) != 0;
            snapshot.Stopped = (flags & 4) != 0;
            snapshot.StopConfirmed = (flags & 12) == 12;
            snapshot.Time_s = BitConverter.Int64BitsToDouble((long)(U32() | (ulong)U32() << 32));
            snapshot.StepCpu_s = 1e-3f * F32();
            snapshot.MatchCpu_s = 1e-3f * F32();
            snapshot.DeadlineMisses = U32();
            int objects = Count(PoseBytes);
            int fingers = Count(4);
            snapshot.Wall_ms = U32();
            snapshot.Stops = U32();
            int softObjects = Count(8);
            if (objects != scene.Objects.Count || fingers != scene.Fingers.Count)
            {
                throw Wrong($"of {objects} objects and {fingers} fingers, the scene has {scene.Objects.Count} and {scene.Fingers.Count}");
            }
            var poses = new Pose[objects];
            for (int i = 0; i < objects; ++i) poses[i] = ReadPose();
            snapshot.X_WO = poses;
            var read = new FingerSnapshot[fingers];
            for (int i = 0; i < fingers; ++i) read[i] = ReadFinger(scene.Fingers[i]);
            snapshot.Fingers = read;
            var soft = new SoftObjectSnapshot[softObjects];
            for (int i = 0; i < softObjects; ++i) soft[i] = ReadSoftObject(scene);
            snapshot.SoftObjects = soft;
            if (at != size) throw Wrong($"{size - at} bytes too long");
            return snapshot;
        }

        FingerSnapshot ReadFinger(SceneFinger of)
        {
            var finger = new FingerSnapshot { X_WFt = ReadPose(), X_WF = ReadPose(), X_FP = ReadPose() };
            finger.ContactArea_m2 = 1e-6f * F32();
            finger.NormalForce_N = F32();
            finger.TangentialForce_N = F32();
            finger.SlipRatio = F32();
            finger.StuckFraction = F32();
            finger.NormalForceSum_N = F32();
            finger.Deviation_m2 = 1e-6f * F32();
            finger.Tick = U32();
            finger.Stages_s = Floats(scene.LatencyStages.Count, 1e-3f);
            finger.DeviceSaid_s = 1e-3f * F32();
            int samples = Count(17), components = Count(4), joints = Count(4), points = Count(12), pieces = Count(32);
            int twinSamples = Count(17), known = Count(4);
            uint flags = U32();
            finger.ForceLimited = (flags & 1) != 0;
            finger.Objective = (int)(flags >> 8);
            finger.DeviceState = Text(StateBytes);
            ReadSkin(finger, samples);
            finger.Configuration = Configuration(components, of);
            finger.Actual = Configuration(known, of);
            finger.Joints = Scaled(joints, of.JointsAreLinear ? 1e-3 : Math.PI / 180);
            finger.Linkage_m = Floats(3 * points, 1e-3f);
            var solid = new Piece[pieces];
            for (int i = 0; i < pieces; ++i) solid[i] = new Piece { X_FS = ReadPose(), Radius_m = 1e-3f * F32() };
            finger.Pieces = solid;
            if (twinSamples > 0) finger.Twin = ReadTwin(twinSamples);
            return finger;
        }

        SoftObjectSnapshot ReadSoftObject(Scene scene)
        {
            uint number = U32();
            if (number >= (uint)scene.Objects.Count) throw Wrong($"of object {number}, the scene has {scene.Objects.Count}");
            var soft = new SoftObjectSnapshot { Object = (int)number, Positions_m = Floats(3 * Count(12), 1e-3f) };
            float[] rest = scene.Objects[soft.Object].Shape.Positions_m;
            if (rest == null || rest.Length != soft.Positions_m.Length) throw Wrong($"{soft.Positions_m.Length / 3} points of object {number}, the scene has others");
            return soft;
        }

        Twin ReadTwin(int samples)
        {
            var twin = new Twin
            {
                Iou = F32(),
                CentroidShift_m = 1e-3f * F32(),
                NormalAngle_rad = Degree * F32(),
                NormalForceError = F32(),
                NormalForceBias = F32(),
                NormalForce_N = F32(),
                ContactArea_m2 = 1e-6f * F32(),
                Press_s = 1e-3f * F32(),
                NormalForceSum_N = F32(),
                TangentialForce_N = F32(),
                TangentialForceError = F32(),
                SlipRatioError = F32(),
            };
            ReadSkin(twin, samples);
            return twin;
        }

        void ReadSkin(Skin skin, int samples)
        {
            skin.Positions_m = Floats(3 * samples, 1e-3f);
            skin.Pressures_Pa = Floats(samples, 1e3f);
            Need(samples);
            skin.InContact = new byte[samples];
            Buffer.BlockCopy(bytes, at, skin.InContact, 0, samples);
            at = (at + samples + 3) & ~3;
        }

        Pose ReadPose()
        {
            float x = F32(), y = F32(), z = F32(), qx = F32(), qy = F32(), qz = F32(), qw = F32();
            return new Pose(1e-3 * x, 1e-3 * y, 1e-3 * z, qw, qx, qy, qz);
        }

        double[] Configuration(int count, SceneFinger of)
        {
            double[] values = Scaled(count, 1);
            for (int i = 0; i < Math.Min(count, of.ConfigurationScales.Length); ++i) values[i] *= of.ConfigurationScales[i];
            return values;
        }

        double[] Scaled(int count, double unit)
        {
            Need(4L * count);
            var values = new double[count];
            for (int i = 0; i < count; ++i) values[i] = unit * F32();
            return values;
        }

        float[] Floats(int count, float unit)
        {
            Need(4L * count);
            var values = new float[count];
            Buffer.BlockCopy(bytes, at, values, 0, 4 * count);
            at += 4 * count;
            for (int i = 0; i < count; ++i) values[i] *= unit;
            return values;
        }

        string Text(int most)
        {
            Need(most);
            int length = 0;
            while (length < most && bytes[at + length] != 0) ++length;
            string text = Encoding.UTF8.GetString(bytes, at, length);
            at += most;
            return text;
        }

        /// <summary>How many of so many bytes each are to come; never more than there is room for.</summary>
        int Count(int each)
        {
            uint count = U32();
            if (count > (uint)(size - at) / (uint)each) throw Wrong($"{count} of what {size - at} bytes cannot hold");
            return (int)count;
        }

        uint U32()
        {
            Need(4);
            at += 4;
            return (uint)(bytes[at - 4] | bytes[at - 3] << 8 | bytes[at - 2] << 16 | bytes[at - 1] << 24);
        }

        float F32()
        {
            Need(4);
            at += 4;
            return BitConverter.ToSingle(bytes, at - 4);
        }

        void Need(long more)
        {
            if (more > size - at) throw Wrong($"cut short after {size} bytes");
        }

        static OperationError Wrong(string what) => new OperationError($"a snapshot: {what}");
    }
}
