using System;
using System.Threading;

namespace Softfinger
{
    /// <summary>A finger pressed on a fixed obstacle, bone prescribed. Zero or false, but for Rows and Depth_m: a plane, quasi-static, friction and strain limits as the finger file has them.</summary>
    public sealed class PressOptions
    {
        /// <summary>1 to 10000; 0: 20.</summary>
        public int Rows { get; set; }

        /// <summary>Greatest displacement of the bone after first touch, at most 0.02; 0: 0.002.</summary>
        public double Depth_m { get; set; }

        /// <summary>Above 0: a sphere, so far under F's origin in x and y.</summary>
        public double SphereRadius_m { get; set; }

        public double AtX_m { get; set; }
        public double AtY_m { get; set; }

        /// <summary>A 90-degree edge along y, rounded.</summary>
        public bool Edge { get; set; }

        public double EdgeRadius_m { get; set; }
        public bool NoStrainLimits { get; set; }
        public bool NoFriction { get; set; }

        /// <summary>Long-time moduli.</summary>
        public bool Relaxed { get; set; }

        /// <summary>Turn about the finger's y axis, distal end down.</summary>
        public double Pitch_rad { get; set; }

        /// <summary>Above 0: stepped in time, then held for so long, in as many rows again.</summary>
        public double Speed_m_per_s { get; set; }

        public double Hold_s { get; set; }

        /// <summary>Then back to first touch, in as many rows again.</summary>
        public bool Unload { get; set; }
    }

    /// <summary>How a device is judged by a second finger. Null or zero: as the scene says.</summary>
    public sealed class EvaluateOptions
    {
        /// <summary>A device file; "NAME=FILE" for one of several fingers.</summary>
        public string Device { get; set; }

        /// <summary>Finger file of who wears the device; null: the simulated finger.</summary>
        public string Wearer { get; set; }

        /// <summary>What matching aims at, instead of the device file's.</summary>
        public string Objective { get; set; }

        /// <summary>A person file.</summary>
        public string Person { get; set; }

        /// <summary>0: until the script ends.</summary>
        public double Duration_s { get; set; }
    }

    /// <summary>How a scene runs. Null, false or zero: as the scene says.</summary>
    public sealed class RunOptions
    {
        /// <summary>A device file; "NAME=FILE" for one of several fingers.</summary>
        public string Device { get; set; }

        /// <summary>Finger file of whom an emulated force sensor is on.</summary>
        public string Wearer { get; set; }

        /// <summary>A person file.</summary>
        public string Person { get; set; }

        /// <summary>A new file that is recorded to; with RecordState nodes and samples of every step as well.</summary>
        public string Recording { get; set; }

        public bool RecordState { get; set; }

        /// <summary>0: until the script ends.</summary>
        public double Duration_s { get; set; }

        /// <summary>Carries tracked poses on over their age and this time more.</summary>
        public double Predict_s { get; set; }

        /// <summary>Smooths tracked poses.</summary>
        public bool Filter { get; set; }

        /// <summary>That step several fingers side by side; 0: one.</summary>
        public int Threads { get; set; }
    }

    /// <summary>What the command line computes without a clock, to the same bits.</summary>
    public static unsafe class Compute
    {
        /// <summary>Of the library, e.g. 0.1.0.</summary>
        public static string Version()
        {
            Native.Need();
            uint version = Native.sf_version();
            return $"{version >> 16}.{version >> 8 & 255}.{version & 255}";
        }

        /// <summary>As `softfinger press FINGER`: a row for each depth.</summary>
        public static Table Press(string finger, PressOptions options = null)
        {
            Native.Need();
            byte[] file = Native.Utf8(finger);
            options = options ?? new PressOptions();
            var native = new Native.PressOptions
            {
                size = (uint)sizeof(Native.PressOptions),
                rows = options.Rows,
                depth_m = options.Depth_m,
                sphere_radius_m = options.SphereRadius_m,
                edge = options.Edge ? 1 : 0,
                no_strain_limits = options.NoStrainLimits ? 1 : 0,
                edge_radius_m = options.EdgeRadius_m,
                no_friction = options.NoFriction ? 1 : 0,
                relaxed = options.Relaxed ? 1 : 0,
                pitch_rad = options.Pitch_rad,
                speed_m_per_s = options.Speed_m_per_s,
                hold_s = options.Hold_s,
                unload = options.Unload ? 1 : 0,
            };
            native.at_m[0] = options.AtX_m;
            native.at_m[1] = options.AtY_m;
            IntPtr table = IntPtr.Zero;
            byte[] error = Native.NewError();
            Native.Check(Native.sf_press(file, &native, out table, error, Native.ErrorSize), error);
            return new Table(table);
        }

        /// <summary>As `softfinger evaluate SCENE`: a row for each device tick of each finger. Cancelled, it gives what was judged until then; OperationError where that is nothing.</summary>
        public static Table Evaluate(string scene, EvaluateOptions options = null, CancellationToken cancel = default(CancellationToken))
        {
            Native.Need();
            byte[] file = Native.Utf8(scene);
            options = options ?? new EvaluateOptions();
            int stop = 0;
            int* flag = &stop;
            IntPtr table = IntPtr.Zero;
            using (var device = new NativeText(options.Device))
            using (var wearer = new NativeText(options.Wearer))
            using (var objective = new NativeText(options.Objective))
            using (var person = new NativeText(options.Person))
            // Its disposal waits for a call that has begun: none writes to what is no longer there.
            using (cancel.Register(() => *flag = 1))
            {
                var native = new Native.EvaluateOptions
                {
                    size = (uint)sizeof(Native.EvaluateOptions),
                    device = device.Pointer,
                    wearer = wearer.Pointer,
                    objective = objective.Pointer,
                    person = person.Pointer,
                    duration_s = options.Duration_s,
                    stop = (IntPtr)flag,
                };
                byte[] error = Native.NewError();
                Native.Check(Native.sf_evaluate(file, &native, out table, error, Native.ErrorSize), error);
            }
            return new Table(table);
        }

        /// <summary>
        /// As `softfinger run SCENE --headless --as-fast-as-possible`, with emulated devices: its report is Table.Json, there are
        /// no columns. Cancelled, it is of what ran until then; OperationError where that is nothing.
        /// </summary>
        public static Table Run(string scene, RunOptions options = null, CancellationToken cancel = default(CancellationToken))
        {
            Native.Need();
            byte[] file = Native.Utf8(scene);
            options = options ?? new RunOptions();
            int stop = 0;
            int* flag = &stop;
            IntPtr table = IntPtr.Zero;
            using (var device = new NativeText(options.Device))
            using (var wearer = new NativeText(options.Wearer))
            using (var person = new NativeText(options.Person))
            using (var recording = new NativeText(options.Recording))
            using (cancel.Register(() => *flag = 1))
            {
                var native = new Native.RunOptions
                {
                    size = (uint)sizeof(Native.RunOptions),
                    record_state = options.RecordState ? 1 : 0,
                    device = device.Pointer,
                    wearer = wearer.Pointer,
                    person = person.Pointer,
                    recording = recording.Pointer,
                    duration_s = options.Duration_s,
                    predict_s = options.Predict_s,
                    filter = options.Filter ? 1 : 0,
                    threads = options.Threads,
                    stop = (IntPtr)flag,
                };
                byte[] error = Native.NewError();
                Native.Check(Native.sf_run(file, &native, out table, error, Native.ErrorSize), error);
            }
            return new Table(table);
        }
    }
}
