using System;

namespace Softfinger
{
    /// <summary>What matching does about the device's limits.</summary>
    public enum MatchLimits
    {
        Inside,
        Clamp,
        None,
    }

    /// <summary>How a match ended.</summary>
    public enum MatchTermination
    {
        Converged,
        IterationLimit,
        Nonsmooth,
    }

    /// <summary>Skin as matching sees it.</summary>
    public sealed class SkinPoints
    {
        /// <summary>x, y, z of each sample in F.</summary>
        public double[] Points_F_m { get; set; }

        /// <summary>One a sample; 1: touches.</summary>
        public byte[] InContact { get; set; }

        /// <summary>One a sample: weights by area; null: all alike.</summary>
        public double[] Areas_m2 { get; set; }

        /// <summary>Virtual gaps, one a sample; null: the separation is constant.</summary>
        public double[] Gaps_m { get; set; }

        /// <summary>Separation tolerance; 0: the device's.</summary>
        public double Separation_m { get; set; }

        public MatchLimits Limits { get; set; }
    }

    public sealed class Match
    {
        /// <summary>In the device's order, rad and m.</summary>
        public double[] Configuration { get; internal set; }

        /// <summary>Null where the linkage does not close.</summary>
        public double[] Joints { get; internal set; }

        /// <summary>Contact surface deviation.</summary>
        public double Deviation_m2 { get; internal set; }

        public int Iterations { get; internal set; }
        public MatchTermination Termination { get; internal set; }
    }

    /// <summary>What a device file describes. Immutable, any thread's. SI units and radians.</summary>
    public sealed unsafe class Device : IDisposable
    {
        readonly DeviceHandle handle;
        readonly Action<int> check;

        public Device(string file)
        {
            Native.Need();
            byte[] path = Native.Utf8(file);
            IntPtr made = IntPtr.Zero;
            byte[] error = Native.NewError();
            Native.Check(Native.sf_device_create(path, out made, error, Native.ErrorSize), error);
            handle = new DeviceHandle(made);
            check = status => Native.Check(status, handle);
            var info = new Native.DeviceInfo { size = (uint)sizeof(Native.DeviceInfo) };
            check(Native.sf_device_describe(handle, &info));
            ConfigurationCount = (int)info.configuration_count;
            JointCount = (int)info.joint_count;
            JointsAreLinear = info.joints_are_linear != 0;
        }

        public int ConfigurationCount { get; }
        public int JointCount { get; }

        /// <summary>m, else rad.</summary>
        public bool JointsAreLinear { get; }

        public void Dispose() => handle.Dispose();

        /// <summary>The file's keys with defaults filled in, as JSON.</summary>
        public string Show() => Native.Text(
            (byte* to, UIntPtr capacity, out UIntPtr count) => Native.sf_device_show(handle, to, capacity, out count), check);

        /// <summary>Name of a component of the configuration with the unit people read, e.g. pitch_deg; unit: that in SI.</summary>
        public string ComponentName(int component, out double unit)
        {
            var name = new byte[256];
            check(Native.sf_device_component(handle, Native.Size(component), name, Native.Size(name.Length), out unit));
            return Native.Text(name);
        }

        public double[] Home()
        {
            var configuration = new double[ConfigurationCount];
            fixed (double* to = configuration) check(Native.sf_device_home(handle, to, Native.Size(configuration.Length)));
            return configuration;
        }

        /// <summary>Joints of a configuration; null where the linkage does not close. reachable: within the workspace.</summary>
        public double[] Solve(double[] configuration, out bool reachable)
        {
            var joints = new double[JointCount];
            int closes, reached;
            check(Native.sf_device_solve(handle, configuration, Native.Size(configuration.Length), joints, Native.Size(joints.Length), out closes, out reached));
            reachable = reached != 0;
            return closes != 0 ? joints : null;
        }

        /// <summary>Configuration of joints. OperationError: none within the workspace has them.</summary>
        public double[] ConfigurationOf(double[] joints)
        {
            var configuration = new double[ConfigurationCount];
            check(Native.sf_device_pose(handle, joints, Native.Size(joints.Length), configuration, Native.Size(configuration.Length)));
            return configuration;
        }

        /// <summary>The configuration whose surface touches the samples in contact and no others.</summary>
        public Match Match(SkinPoints skin)
        {
            if (skin.Points_F_m == null || skin.InContact == null) throw new InputError("a match: Points_F_m and InContact are wanted");
            int samples = skin.InContact.Length;
            NeedLength(skin.Points_F_m, 3 * samples, nameof(skin.Points_F_m));
            NeedLength(skin.Areas_m2 ?? new double[samples], samples, nameof(skin.Areas_m2));
            NeedLength(skin.Gaps_m ?? new double[samples], samples, nameof(skin.Gaps_m));
            fixed (double* points = skin.Points_F_m, areas = skin.Areas_m2, gaps = skin.Gaps_m)
            fixed (byte* touches = skin.InContact)
            {
                var native = new Native.Points
                {
                    size = (uint)sizeof(Native.Points),
                    count = (uint)samples,
                    points_F_m = points,
                    in_contact = touches,
                    areas_m2 = areas,
                    gaps_m = gaps,
                    separation_m = skin.Separation_m,
                    limits = (int)skin.Limits,
                };
                var match = new Native.Match { size = (uint)sizeof(Native.Match) };
                check(Native.sf_device_match(handle, &native, &match));
                return new Match
                {
                    Configuration = Native.Copy(match.configuration, match.configuration_count),
                    Joints = match.joints_exist != 0 ? Native.Copy(match.joints, match.joint_count) : null,
                    Deviation_m2 = match.deviation_m2,
                    Iterations = match.iterations,
                    Termination = (MatchTermination)match.termination,
                };
            }
        }

        static void NeedLength(double[] array, int length, string name)
        {
            if (array.Length != length) throw new InputError($"a match: {name}: {length} numbers are wanted");
        }
    }
}
