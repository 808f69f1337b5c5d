using System;

namespace Softfinger
{
    /// <summary>What a device does.</summary>
    public enum DeviceState
    {
        /// <summary>Its port is not open; attempts to open it go on.</summary>
        Disconnected,

        /// <summary>Moves to where it is wanted for the first time, or again after a gap.</summary>
        Homing,

        /// <summary>Follows, nothing is touched.</summary>
        Ready,

        /// <summary>Follows, something is touched.</summary>
        Rendering,

        /// <summary>Tracking is lost for less than 200 ms: keeps its last pose.</summary>
        Holding,

        /// <summary>Moves to the retracted pose, or is there.</summary>
        Retracting,

        /// <summary>No command follows.</summary>
        Stopped,
    }

    /// <summary>What the device is told. Arrays are empty where there is no device.</summary>
    public sealed class Command
    {
        static readonly double[] None = new double[0];

        public DeviceState State { get; private set; }

        /// <summary>Counts the device's ticks from 0; -1 before the first.</summary>
        public long Tick { get; private set; }

        /// <summary>Of that tick, on the caller's clock.</summary>
        public double Time_s { get; private set; }

        /// <summary>Contact surface deviation of the match; 0 where nothing is touched.</summary>
        public double Deviation_m2 { get; private set; }

        /// <summary>q in the device's order, rad and m.</summary>
        public double[] Configuration { get; private set; } = None;

        /// <summary>Of q; rad, or m where they are linear.</summary>
        public double[] Joints { get; private set; } = None;

        /// <summary>One a servo, as its bus has it: a pulse width in s, or ticks, or a share.</summary>
        public double[] SetPoints { get; private set; } = None;

        /// <summary>Rendering.Stop or somebody else stopped it.</summary>
        public bool Stopped { get; private set; }

        /// <summary>And it is a fact: who leads the servos has led them away.</summary>
        public bool StopConfirmed { get; private set; }

        /// <summary>How often it was stopped so far.</summary>
        public uint Stops { get; private set; }

        internal unsafe void Take(Native.Command* from)
        {
            State = (DeviceState)from->state;
            Tick = from->tick;
            Time_s = from->time_s;
            Deviation_m2 = from->deviation_m2;
            Configuration = Copy(from->configuration, from->configuration_count, Configuration);
            Joints = Copy(from->joints, from->joint_count, Joints);
            SetPoints = Copy(from->set_points, from->set_point_count, SetPoints);
            Stopped = from->stopped != 0;
            StopConfirmed = from->stop_confirmed != 0;
            Stops = from->stops;
        }

        static unsafe double[] Copy(double* from, uint count, double[] into)
        {
            if (into.Length != count) return Native.Copy(from, count);
            for (int i = 0; i < into.Length; ++i) into[i] = from[i];
            return into;
        }
    }

    public struct Vector
    {
        public readonly double X, Y, Z;

        internal unsafe Vector(double* xyz)
        {
            X = xyz[0];
            Y = xyz[1];
            Z = xyz[2];
        }
    }

    /// <summary>Sums of the finger's contact; forces are those on the finger, in F.</summary>
    public struct ContactSums
    {
        public readonly int SamplesInContact;

        /// <summary>End of the last step, on the caller's clock.</summary>
        public readonly double Time_s;

        /// <summary>Magnitude of the vector sum of the normal forces.</summary>
        public readonly double NormalForce_N;

        /// <summary>Likewise.</summary>
        public readonly double TangentialForce_N;

        public readonly double ContactArea_m2;

        /// <summary>Weighted by force; zero without contact.</summary>
        public readonly Vector Centroid_F_m;

        /// <summary>Of length 1, out of the object; zero without contact.</summary>
        public readonly Vector MeanNormal_F;

        /// <summary>Sum of the magnitudes.</summary>
        public readonly double NormalForceSum_N;

        /// <summary>0 nothing pulls, 1 all that touches slides one way.</summary>
        public readonly double SlipRatio;

        internal unsafe ContactSums(Native.Contact* from)
        {
            SamplesInContact = (int)from->samples_in_contact;
            Time_s = from->time_s;
            NormalForce_N = from->normal_force_N;
            TangentialForce_N = from->tangential_force_N;
            ContactArea_m2 = from->contact_area_m2;
            Centroid_F_m = new Vector(from->centroid_F_m);
            MeanNormal_F = new Vector(from->mean_normal_F);
            NormalForceSum_N = from->normal_force_sum_N;
            SlipRatio = from->slip_ratio;
        }
    }

    /// <summary>What does not change over the life of a Rendering.</summary>
    public struct RenderingInfo
    {
        /// <summary>Of the skin.</summary>
        public readonly int SampleCount;

        public readonly int TriangleCount;
        public readonly int ObjectCount;

        /// <summary>0: no device.</summary>
        public readonly int ConfigurationCount;

        public readonly int JointCount;
        public readonly double SimulationRate_Hz;

        /// <summary>0: no device.</summary>
        public readonly double DeviceRate_Hz;

        public readonly int FingerCount;

        internal RenderingInfo(Native.Info from)
        {
            SampleCount = (int)from.sample_count;
            TriangleCount = (int)from.triangle_count;
            ObjectCount = (int)from.object_count;
            ConfigurationCount = (int)from.configuration_count;
            JointCount = (int)from.joint_count;
            SimulationRate_Hz = from.simulation_rate_Hz;
            DeviceRate_Hz = from.device_rate_Hz;
            FingerCount = (int)from.finger_count;
        }
    }

    /// <summary>An object after the last step.</summary>
    public struct ObjectMotion
    {
        /// <summary>By the forces on it, as a whole or in part; else what follows is zero.</summary>
        public readonly bool Moves;

        /// <summary>It deforms: see Rendering.ObjectPositions.</summary>
        public readonly bool IsSoft;

        /// <summary>Of a slider, m, or a hinge, rad; null: it has neither.</summary>
        public readonly double? Joint;

        /// <summary>Of its centre of mass, in W.</summary>
        public readonly Vector Velocity_m_per_s;

        public readonly Vector AngularVelocity_rad_per_s;

        internal unsafe ObjectMotion(Native.Object* from)
        {
            Moves = from->moves != 0;
            IsSoft = from->soft != 0;
            Joint = from->has_joint != 0 ? from->joint : (double?)null;
            Velocity_m_per_s = new Vector(from->velocity_m_per_s);
            AngularVelocity_rad_per_s = new Vector(from->angular_velocity_rad_per_s);
        }
    }

    public enum ObjectEventKind
    {
        None,

        /// <summary>Two that did not touch for 20 ms or more begin to.</summary>
        Impact,

        /// <summary>They have not touched for 20 ms.</summary>
        Release,

        /// <summary>A slider passes the top of its force curve inwards, or its valley outwards.</summary>
        Click,

        /// <summary>The nearest rest position of a knob is another.</summary>
        Detent,

        /// <summary>A joint meets its limit after 20 ms away from it.</summary>
        Limit,
    }

    /// <summary>What happened to an object that moves.</summary>
    public sealed class ObjectEvent
    {
        public ObjectEventKind Kind { get; }

        /// <summary>On the caller's clock.</summary>
        public double Time_s { get; }

        /// <summary>Of the normal force over the first 10 ms, or along a joint; NaN: none.</summary>
        public double Impulse_N_s { get; }

        /// <summary>Its number; so of the others, null: none.</summary>
        public int Object { get; }

        public int? OtherObject { get; }
        public int? OtherFinger { get; }

        internal ObjectEvent(Native.Event from)
        {
            Kind = (ObjectEventKind)from.kind;
            Time_s = from.time_s;
            Impulse_N_s = from.impulse_N_s;
            Object = (int)from.@object;
            OtherObject = from.other_object >= 0 ? from.other_object : (int?)null;
            OtherFinger = from.other_finger >= 0 ? from.other_finger : (int?)null;
        }
    }
}
