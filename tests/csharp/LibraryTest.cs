using System;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Threading;
using Softfinger;

/// <summary>The shared library by P/Invoke: LibraryTest CASE FILE [MORE]. What it prints is compared with C and the command line.</summary>
static unsafe class LibraryTest
{
    static int Main(string[] arguments)
    {
        string file = arguments[1], more = arguments.Length > 2 ? arguments[2] : null;
        switch (arguments[0])
        {
            case "steps": return Check.Status(() => Steps(file, more));
            case "press": return Check.Status(() => Press(file));
            case "evaluate": return Check.Status(() => Evaluate(file, more));
            case "run": return Check.Status(() => Run(file, more, arguments[3]));
            case "device": return Check.Status(() => OfDevice(file));
            case "rendering": return Check.Status(() => OfRendering(file, more, arguments[3]));
            case "several": return Check.Status(() => Several(file));
            case "refuse": return Check.Status(() => Refuse(file, more));
            case "without": return Check.Status(() => Without(file));
            default: throw new ArgumentException(arguments[0]);
        }
    }

    static string Bits(double number) => BitConverter.DoubleToInt64Bits(number).ToString("x16", CultureInfo.InvariantCulture);

    static void Print(string name, params double[] values)
    {
        Console.Write(name);
        foreach (double value in values) Console.Write(" " + Bits(value));
        Console.WriteLine();
    }

    static void Print(string name, Pose pose)
    {
        Print(name, pose.X_m, pose.Y_m, pose.Z_m);
        Print(name, pose.Qw, pose.Qx, pose.Qy, pose.Qz);
    }

    /// <summary>Index and thumb close on the cup, as in C.</summary>
    static void Several(string scene)
    {
        using (var rendering = new Rendering(scene, new RenderingOptions { AllFingers = true, Threads = 2 }))
        {
            Check.Equal(rendering.Info.FingerCount, 2, "fingers");
            Check.Equal(rendering.FingerName(0) + " " + rendering.FingerName(1), "index thumb", "names");
            double half = Math.Sqrt(0.5);
            Pose? index = null, thumb = null;
            for (int i = 0; i <= 400; ++i)
            {
                double time_s = i / 400.0, x = 46e-3 - 11e-3 * Math.Min(1.0, 1.25 * time_s);
                index = new Pose(x, 0, 52e-3, half, 0, half, 0);
                thumb = new Pose(-x, 0, 52e-3, 0, half, 0, -half);
                rendering.StepAll(new[] { index, thumb }, time_s);
            }
            var forces_N = new double[2];
            for (int finger = 0; finger < 2; ++finger)
            {
                rendering.Select(finger);
                forces_N[finger] = rendering.Contact().NormalForce_N;
                Check.Equal(rendering.NewestCommand().State, DeviceState.Rendering, "state");
                Check.Equal(rendering.Positions().Length, 3 * rendering.Info.SampleCount, "samples");
            }
            Check.That(Math.Min(forces_N[0], forces_N[1]) > 0.2 && Math.Max(forces_N[0], forces_N[1]) < 5, $"held by {forces_N[0]} and {forces_N[1]} N");
            ObjectMotion cup = rendering.MotionOf(0);
            Check.That(cup.Moves && !cup.IsSoft && cup.Joint == null && !rendering.MotionOf(1).Moves, "cup and table");
            Check.Equal(rendering.ObjectPositions(0).Length + rendering.ObjectTriangles(0).Length, 0, "it keeps its shape");
            int met = 0;
            for (ObjectEvent told = rendering.TakeEvent(); told != null; told = rendering.TakeEvent())
            {
                if (told.Kind != ObjectEventKind.Impact || told.OtherFinger == null) continue;
                met += 1 + told.OtherFinger.Value;
                Check.That(told.Object == 0 && told.Impulse_N_s > 0 && told.Time_s > 0 && told.Time_s < 1, "impact");
            }
            Check.Equal(met, 3, "each finger meets it once");
            for (int i = 1; i <= 300; ++i) rendering.StepAll(new[] { index, null }, 1 + i / 1000.0);
            Check.Equal(rendering.NewestCommand().State, DeviceState.Retracting, "the thumb is lost");
        }
    }

    /// <summary>As steps.c does.</summary>
    static void Steps(string scene, string device)
    {
        Console.WriteLine($"sizes {sizeof(Native.Options)} {sizeof(Native.Pose)} {sizeof(Native.UnityPose)} {sizeof(Native.Command)} " +
            $"{sizeof(Native.Contact)} {sizeof(Native.Info)} {sizeof(Native.PressOptions)} {sizeof(Native.EvaluateOptions)} {sizeof(Native.RunOptions)} " +
            $"{sizeof(Native.DeviceInfo)} {sizeof(Native.Points)} {sizeof(Native.Match)}");
        using (var rendering = new Rendering(scene, new RenderingOptions { Device = device }))
        {
            double most_N = 0;
            for (int i = 0; i <= 500; ++i)
            {
                double time_s = i / 1000.0, depth = time_s / 0.5;
                var X_WFt = new Pose(2e-3 * depth, 0, 8.5e-3 - 4e-3 * depth, 0.9987502603949663, 0, 0.04997916927067833, 0);
                Command command = i == 300 ? rendering.Lost(time_s) : rendering.Step(X_WFt, time_s);
                if (i % 20 != 0) continue;
                ContactSums contact = rendering.Contact();
                Print(command);
                Print(contact);
                most_N = Math.Max(most_N, contact.NormalForce_N);
            }
            Check.That(most_N > 0.3, $"{most_N} N");
            Print("positions", rendering.Positions());
            Print("pressures", rendering.Pressures());
            Console.WriteLine("in_contact " + string.Join(" ", rendering.InContact()));
            Console.WriteLine("triangles " + string.Join(" ", rendering.Triangles()));
            PrintRest(rendering);
        }
    }

    static void Print(Command command)
    {
        Console.WriteLine($"command {(int)command.State} {command.Tick.ToString(CultureInfo.InvariantCulture)} {(command.Stopped ? 1 : 0)} {(command.StopConfirmed ? 1 : 0)} {command.Stops}");
        Print("time", command.Time_s);
        Print("deviation", command.Deviation_m2);
        Print("configuration", command.Configuration);
        Print("joints", command.Joints);
        Print("set_points", command.SetPoints);
    }

    static void Print(ContactSums contact)
    {
        Console.WriteLine($"contact {contact.SamplesInContact}");
        Print("time", contact.Time_s);
        Print("normal", contact.NormalForce_N);
        Print("tangential", contact.TangentialForce_N);
        Print("area", contact.ContactArea_m2);
        Print("centroid", contact.Centroid_F_m.X, contact.Centroid_F_m.Y, contact.Centroid_F_m.Z);
        Print("mean_normal", contact.MeanNormal_F.X, contact.MeanNormal_F.Y, contact.MeanNormal_F.Z);
        Print("normal_sum", contact.NormalForceSum_N);
        Print("slip", contact.SlipRatio);
    }

    static void PrintRest(Rendering rendering)
    {
        RenderingInfo info = rendering.Info;
        Console.WriteLine($"info {info.SampleCount} {info.TriangleCount} {info.ObjectCount} {info.ConfigurationCount} {info.JointCount}");
        Print("rates", info.SimulationRate_Hz, info.DeviceRate_Hz);
        Print("X_WFt", rendering.X_WFt());
        Print("X_WF", rendering.X_WF());
        UnityPose unity = UnityPose.From(rendering.X_WF());
        Print("unity", unity.X_m, unity.Y_m, unity.Z_m);
        Print("unity", unity.Qx, unity.Qy, unity.Qz, unity.Qw);
        for (int i = 0; i < info.ObjectCount; ++i) Print(rendering.ObjectName(i), rendering.X_WO(i));
        for (int i = 0; i < info.ConfigurationCount; ++i) Console.WriteLine(rendering.ConfigurationName(i));
        Pose back = unity.ToPose();
        Check.That(Math.Abs(back.X_m - rendering.X_WF().X_m) < 1e-15 && Math.Abs(back.Qy - rendering.X_WF().Qy) < 1e-15, "there and back");
    }

    static void Press(string finger)
    {
        foreach (PressOptions options in new[]
        {
            new PressOptions { Rows = 3, Depth_m = 1e-3 },
            new PressOptions { Rows = 3, Depth_m = 0.7 * 1e-3, SphereRadius_m = 6e-3, AtX_m = 1e-3, AtY_m = -2e-3, NoFriction = true, Pitch_rad = 20 * (Math.PI / 180) },
            new PressOptions { Rows = 3, Depth_m = 0.5 * 1e-3, Edge = true, EdgeRadius_m = 2e-3, NoStrainLimits = true },
            new PressOptions { Rows = 2, Depth_m = 0.5 * 1e-3, Speed_m_per_s = 10e-3, Hold_s = 0.05, Unload = true },
        })
        {
            Table curve = Compute.Press(finger, options);
            double[] force_N = curve["normal_force_N"];
            Check.Equal(force_N.Length, curve.Rows, "rows");
            Check.That(curve.Names[0].StartsWith("indentation") || curve.Names.Count > 3, "columns");
            Check.That(force_N[options.Rows - 1] > 0.01, "force");
            Check.Throws<InputError>(() => force_N = curve["no_such"], "no column no_such: there is");
            Console.WriteLine(curve.Json.TrimEnd());
        }
    }

    static void Evaluate(string scene, string device)
    {
        var options = new EvaluateOptions { Device = device, Duration_s = 1.2 };
        Table judged = Compute.Evaluate(scene, options);
        Console.WriteLine(judged.Json.TrimEnd());
        double[] forces_N = judged["virtual_force_N"];
        Check.That(forces_N[forces_N.Length - 1] > 0.1, "force");
        // Its flag is seen from the start.
        using (var cancel = new CancellationTokenSource())
        {
            cancel.Cancel();
            Check.Throws<OperationError>(() => Compute.Evaluate(scene, options, cancel.Token), "ended while the scene was loading");
        }
    }

    static void Run(string scene, string device, string folder)
    {
        string recording = Path.Combine(folder, "run.sqlite");
        Table run = Compute.Run(scene, new RunOptions { Device = device, Duration_s = 1.2, Recording = recording });
        Check.Equal(run.Names.Count, 0, "columns");
        using (var rendering = new Rendering(scene, new RenderingOptions { Device = device }))
        {
            var command = new Command();
            rendering.MoveObject(0, new Pose(0, 0, -0.002));
            for (int i = 0; i <= 400; ++i)
            {
                rendering.MoveObject(0, new Pose(0, 0, -0.002 + 1e-5 * i));
                rendering.Step(new Pose(0, 0, 8.5e-3), i / 1000.0, command);
            }
            Check.That(Math.Abs(rendering.X_WO(0).Z_m - 0.002) < 1e-9, "the table is where it was put");
            Check.That(rendering.Contact().NormalForce_N > 0.2, "and presses the finger");
            Check.Throws<InputError>(() => rendering.MoveObject(1, Pose.Identity), "object");
        }
        Check.Equal(Recordings.Replay(recording), null, "replay");
        Console.WriteLine(run.Json.TrimEnd());
        Check.Throws<InputError>(() => Compute.Run(scene, new RunOptions { Recording = recording }), recording);
    }

    static void OfDevice(string file)
    {
        using (var device = new Device(file))
        {
            Console.WriteLine(device.Show().TrimEnd());
            double unit;
            Check.Equal(device.ComponentName(0, out unit), "pitch_deg", "name");
            Check.That(Math.Abs(unit - Math.PI / 180) < 1e-15, "unit");
            double[] configuration = device.Home();
            configuration[0] += 5 * unit;
            configuration[2] += 1e-3;
            bool reachable;
            double[] joints = device.Solve(configuration, out reachable);
            Check.That(reachable && joints.Length == device.JointCount && !device.JointsAreLinear, "solved");
            double[] back = device.ConfigurationOf(joints);
            for (int i = 0; i < back.Length; ++i) Check.That(Math.Abs(back[i] - configuration[i]) < 1e-9, "and back");
            Check.Throws<OperationError>(() => device.ConfigurationOf(new[] { 0.0, 1.5, 0.0 }), "");
            configuration[2] = 0.5;
            Check.That(device.Solve(configuration, out reachable) == null && !reachable, "out of reach");
            Check.Throws<InputError>(() => device.Solve(new double[1], out reachable), "");
            Check.Throws<InputError>(() => device.ComponentName(-1, out unit), "");
            Check.Throws<InputError>(() => device.Match(new SkinPoints { Points_F_m = new double[3], InContact = new byte[2] }), "Points_F_m: 6 numbers are wanted");
            device.Dispose();
            Check.Throws<ObjectDisposedException>(() => device.Show(), "");
        }
    }

    /// <summary>Stop and release, a recording, a match that is the command's, and steps that leave no garbage.</summary>
    static void OfRendering(string scene, string device, string folder)
    {
        string recording = Path.Combine(folder, "\u00fcbung.sqlite"), exported = Path.Combine(folder, "exported");
        Check.Equal(string.Join(" ", Rendering.FingersOf(scene)), "index", "fingers");
        using (var rendering = new Rendering(scene, new RenderingOptions { Finger = "index", Device = device, Recording = recording }))
        {
            var command = new Command();
            double z_m = 8.5e-3;
            int i = 0;
            for (; i <= 400; ++i) rendering.Step(new Pose(0, 0, z_m -= 8e-6), i / 1000.0, command);
            Check.That(rendering.Contact().NormalForce_N > 0.1 && command.Tick > 5, "touches");
            Check.That(command.Configuration.Length == 2 && command.Joints.Length == 2 && command.State == DeviceState.Rendering, "rendered");

            long before = GC.GetAllocatedBytesForCurrentThread();
            for (; i <= 500; ++i) rendering.Step(new Pose(0, 0, z_m), i / 1000.0, command);
            Check.Equal(GC.GetAllocatedBytesForCurrentThread() - before, 0L, "garbage of 100 steps");

            rendering.Stop();
            for (; i <= 900 && !command.StopConfirmed; ++i) rendering.Step(new Pose(0, 0, 0.02), i / 1000.0, command);
            Check.That(command.Stopped && command.StopConfirmed && command.Stops > 0, "stopped");
            Check.That(rendering.TakeMessage() != null, "told");
            for (int more = 0; more < 1000; ++more, ++i) rendering.Step(new Pose(0, 0, 0.02), i / 1000.0, command);
            rendering.Release();
            for (int more = 0; more < 50; ++more, ++i) rendering.Step(new Pose(0, 0, 0.02), i / 1000.0, command);
            Check.That(!command.Stopped, "released");
            Check.Throws<OperationError>(() => rendering.Release(), "");
            rendering.CloseRecording();
        }
        Check.Equal(Recordings.Replay(recording), null, "replay");
        Check.Equal(Recordings.Export(recording, exported), null, "export");
        Check.That(File.Exists(Path.Combine(exported, "force.csv")), "force.csv");
        Check.Throws<InputError>(() => Recordings.Export(recording, exported), "exported");
    }

    static void Refuse(string scene, string device)
    {
        try
        {
            new Rendering(device);
            Check.That(false, "a device is no scene");
        }
        catch (InputError error)
        {
            Check.Equal(error.File, device, "file");
            Check.That(error.Message.IndexOf('\n') < 0, "one line");
        }
        Check.Throws<InputError>(() => new Rendering("nowhere.toml"), "nowhere.toml");
        Check.Throws<InputError>(() => new Rendering(null), "");
        Check.Throws<InputError>(() => new Rendering("a\0b"), "no character of it may be zero");
        Check.Throws<InputError>(() => new Rendering(scene, new RenderingOptions { Finger = "toe", Device = device }), "toe");
        Check.Throws<InputError>(() => new Rendering(scene, new RenderingOptions { Predict_s = 1, Device = device }), "");
        Check.Throws<InputError>(() => new Device(scene), scene);
        Check.Throws<InputError>(() => Compute.Press(scene), scene);
        Check.Throws<InputError>(() => Compute.Evaluate("nowhere.toml"), "nowhere.toml");
        Check.Throws<InputError>(() => Recordings.Replay("nowhere.sqlite"), "nowhere.sqlite");
        Check.Throws<InputError>(() => Rendering.FingersOf(device), device);
        var rendering = new Rendering(scene, new RenderingOptions { Device = device });
        Check.Throws<InputError>(() => rendering.Step(new Pose(double.NaN, 0, 0), 0), "");
        rendering.Step(new Pose(0, 0, 0.02), 0);
        Check.Throws<InputError>(() => rendering.Step(new Pose(0, 0, 0.02), -1), "");
        Check.Throws<InputError>(() => rendering.Positions(new double[3]), "xyz_F_m: ");
        Check.Throws<InputError>(() => rendering.ObjectName(-1), "");
        Check.Throws<InputError>(() => rendering.X_WO(99), "");
        rendering.Dispose();
        rendering.Dispose();
        Check.Throws<ObjectDisposedException>(() => rendering.Stop(), "");
        Check.Throws<ObjectDisposedException>(() => rendering.Step(new Pose(0, 0, 0.02), 1), "");
        Check.Equal(Compute.Version().Split('.').Length, 3, "version");
    }

    /// <summary>Where the library is not.</summary>
    static void Without(string scene)
    {
        Check.Throws<OperationError>(() => new Rendering(scene), "libsoftfinger.so.0 is not found");
        Check.Throws<OperationError>(() => Compute.Version(), "libsoftfinger.so.0 is not found");
    }
}
