using System.Collections.Generic;

namespace Softfinger
{
    /// <summary>The state of a running scene at one instant. SI units and radians; forces are those on the finger.</summary>
    public sealed class Snapshot : Message
    {
        /// <summary>Low bits of the scene's.</summary>
        public uint Generation { get; internal set; }

        public uint Step { get; internal set; }
        public bool Paused { get; internal set; }

        /// <summary>The script has come to its end.</summary>
        public bool Finished { get; internal set; }

        /// <summary>A device is to be stopped: it is led away, and stays so until it is released.</summary>
        public bool Stopped { get; internal set; }

        /// <summary>And it is a fact: all that are to be stopped are, as those say that lead their servos.</summary>
        public bool StopConfirmed { get; internal set; }

        /// <summary>How often devices were stopped so far.</summary>
        public uint Stops { get; internal set; }

        /// <summary>Simulated.</summary>
        public double Time_s { get; internal set; }

        /// <summary>Of the program's clock, of any origin, when it was taken; wraps around.</summary>
        public uint Wall_ms { get; internal set; }

        /// <summary>Time on the processor of the last step, and of the last match.</summary>
        public float StepCpu_s { get; internal set; }

        public float MatchCpu_s { get; internal set; }
        public uint DeadlineMisses { get; internal set; }

        /// <summary>One for each of the scene's objects.</summary>
        public IReadOnlyList<Pose> X_WO { get; internal set; }

        /// <summary>One for each of the scene's.</summary>
        public IReadOnlyList<FingerSnapshot> Fingers { get; internal set; }

        /// <summary>One for each of the scene's objects of kind soft, in its order.</summary>
        public IReadOnlyList<SoftObjectSnapshot> SoftObjects { get; internal set; }
    }

    /// <summary>The surface of an object of kind soft as it stands.</summary>
    public sealed class SoftObjectSnapshot
    {
        /// <summary>Its place in Scene.Objects.</summary>
        public int Object { get; internal set; }

        /// <summary>x, y, z in O of the points of its shape.</summary>
        public float[] Positions_m { get; internal set; }
    }

    /// <summary>Skin in contact; n samples.</summary>
    public class Skin
    {
        /// <summary>x, y, z of each sample in F; 3 n.</summary>
        public float[] Positions_m { get; internal set; }

        public float[] Pressures_Pa { get; internal set; }

        /// <summary>1 where skin around the sample touches, else 0.</summary>
        public byte[] InContact { get; internal set; }
    }

    public sealed class FingerSnapshot : Skin
    {
        /// <summary>Tracked.</summary>
        public Pose X_WFt { get; internal set; }

        /// <summary>Simulated; in contact it stays behind.</summary>
        public Pose X_WF { get; internal set; }

        /// <summary>Platform of the commanded configuration.</summary>
        public Pose X_FP { get; internal set; }

        public float ContactArea_m2 { get; internal set; }

        /// <summary>Magnitude of the vector sum of the normal forces.</summary>
        public float NormalForce_N { get; internal set; }

        /// <summary>Likewise.</summary>
        public float TangentialForce_N { get; internal set; }

        /// <summary>0 nothing pulls, 1 all that touches slides one way.</summary>
        public float SlipRatio { get; internal set; }

        /// <summary>Of the contact area.</summary>
        public float StuckFraction { get; internal set; }

        /// <summary>Sum of the magnitudes.</summary>
        public float NormalForceSum_N { get; internal set; }

        /// <summary>Contact surface deviation of the last match.</summary>
        public float Deviation_m2 { get; internal set; }

        /// <summary>Of the device; low bits.</summary>
        public uint Tick { get; internal set; }

        /// <summary>Of that tick, one each of Scene.LatencyStages; NaN: unknown.</summary>
        public float[] Stages_s { get; internal set; }

        /// <summary>How long ago who leads the servos last showed life; NaN: nobody does.</summary>
        public float DeviceSaid_s { get; internal set; }

        /// <summary>disconnected, homing, ready, rendering, holding, retracting, stopped, ...; empty: no device.</summary>
        public string DeviceState { get; internal set; }

        /// <summary>The device would advance further but for its limit of force.</summary>
        public bool ForceLimited { get; internal set; }

        /// <summary>What leads the device: its place in Scene.Objectives.</summary>
        public int Objective { get; internal set; }

        /// <summary>Commanded q in the device's order, rad and m; see SceneFinger.ConfigurationNames.</summary>
        public double[] Configuration { get; internal set; }

        /// <summary>The same as the servos say; empty: they do not.</summary>
        public double[] Actual { get; internal set; }

        /// <summary>Of the commanded q; rad, or m where they are linear.</summary>
        public double[] Joints { get; internal set; }

        /// <summary>x, y, z in F of base joint, knee and platform joint of each leg.</summary>
        public float[] Linkage_m { get; internal set; }

        /// <summary>Rigid parts of the device's solid; see SceneFinger.Pieces.</summary>
        public IReadOnlyList<Piece> Pieces { get; internal set; }

        /// <summary>The second finger, pressed by the device; null: not pressed yet, or there is none.</summary>
        public Twin Twin { get; internal set; }
    }

    public struct Piece
    {
        public Pose X_FS;

        /// <summary>Of a ball, which may grow; else 0.</summary>
        public float Radius_m;
    }

    /// <summary>The second finger against the virtual one; NaN where a measure is not defined.</summary>
    public sealed class Twin : Skin
    {
        public float Iou { get; internal set; }
        public float CentroidShift_m { get; internal set; }
        public float NormalAngle_rad { get; internal set; }
        public float NormalForceError { get; internal set; }
        public float NormalForceBias { get; internal set; }
        public float NormalForce_N { get; internal set; }
        public float ContactArea_m2 { get; internal set; }
        public float Press_s { get; internal set; }
        public float NormalForceSum_N { get; internal set; }
        public float TangentialForce_N { get; internal set; }
        public float TangentialForceError { get; internal set; }
        public float SlipRatioError { get; internal set; }
    }
}
