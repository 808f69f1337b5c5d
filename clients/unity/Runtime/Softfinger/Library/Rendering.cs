using System;
using System.Collections.Generic;

namespace Softfinger
{
    /// <summary>How a Rendering is made. Null, false or zero: the default.</summary>
    public sealed class RenderingOptions
    {
        /// <summary>Name of a finger of the scene; the first by default.</summary>
        public string Finger { get; set; }

        /// <summary>All fingers of the scene, in its order, whatever Finger says: they touch the same objects, and can hold them.</summary>
        public bool AllFingers { get; set; }

        /// <summary>That step several fingers side by side; 0: one.</summary>
        public int Threads { get; set; }

        /// <summary>A device file instead of the scene's; with AllFingers NAME=FILE.</summary>
        public string Device { get; set; }

        /// <summary>Commands are sent, by softfinger-guard, a process of its own: whatever becomes of this one, the device is retracted. Else they are only formed.</summary>
        public bool OpenDevice { get; set; }

        /// <summary>softfinger-guard, where it is neither with the library nor installed.</summary>
        public string GuardProgram { get; set; }

        /// <summary>A person file: sizes of the fingers.</summary>
        public string Person { get; set; }

        /// <summary>A new file that is recorded to; with RecordState nodes and samples of every step as well.</summary>
        public string Recording { get; set; }

        public bool RecordState { get; set; }

        /// <summary>Poses are smoothed by the one-euro filter.</summary>
        public bool Filter { get; set; }

        /// <summary>Poses are carried on by this much, 0 to 0.05.</summary>
        public double Predict_s { get; set; }
    }

    /// <summary>
    /// A soft finger explores a scene, a device answers: in this process, by libsoftfinger.so.0. SI units and radians.
    ///
    ///     using (var rendering = new Rendering("scenes/sphere.toml"))
    ///     {
    ///         Command command = rendering.Step(X_WFt, time_s);  // simulates up to now
    ///     }
    ///
    /// One thread at a time: a second one inside a call is refused. Stop() is any thread's. The same calls give the
    /// same bits. Dispose retracts the device, which may take a second. Throws InputError and OperationError.
    /// </summary>
    public sealed unsafe class Rendering : IDisposable
    {
        readonly RenderingHandle handle;
        readonly Action<int> check;
        Native.Command command;

        /// <summary>Reads the scene and what it names; trackers and waypoints in it are ignored.</summary>
        public Rendering(string scene, RenderingOptions options = null)
        {
            Native.Need();
            options = options ?? new RenderingOptions();
            byte[] file = Native.Utf8(scene);
            using (var finger = new NativeText(options.Finger))
            using (var device = new NativeText(options.Device))
            using (var guard = new NativeText(options.GuardProgram))
            using (var person = new NativeText(options.Person))
            using (var recording = new NativeText(options.Recording))
            {
                var native = new Native.Options
                {
                    size = (uint)sizeof(Native.Options),
                    finger = finger.Pointer,
                    device = device.Pointer,
                    open_device = options.OpenDevice ? 1 : 0,
                    guard_program = guard.Pointer,
                    person = person.Pointer,
                    recording = recording.Pointer,
                    record_state = options.RecordState ? 1 : 0,
                    filter = options.Filter ? 1 : 0,
                    predict_s = options.Predict_s,
                    all_fingers = options.AllFingers ? 1 : 0,
                    threads = options.Threads,
                };
                IntPtr made = IntPtr.Zero;
                byte[] error = Native.NewError();
                Native.Check(Native.sf_rendering_create(file, &native, out made, error, Native.ErrorSize), error);
                handle = new RenderingHandle(made);
            }
            check = status => Native.Check(status, handle);
            command.size = (uint)sizeof(Native.Command);
            Info = ReadInfo();
        }

        /// <summary>Names of the fingers of a scene file, in its order. See RenderingOptions for one of them or all.</summary>
        public static IReadOnlyList<string> FingersOf(string scene)
        {
            Native.Need();
            byte[] file = Native.Utf8(scene);
            var names = new List<string>();
            byte[] name = new byte[256], error = Native.NewError();
            UIntPtr count = (UIntPtr)1;
            while ((ulong)names.Count < (ulong)count)
            {
                fixed (byte* to = name)
                {
                    Native.Check(Native.sf_scene_finger(file, Native.Size(names.Count), to, Native.Size(name.Length), out count, error, Native.ErrorSize), error);
                }
                names.Add(Native.Text(name));
            }
            return names;
        }

        /// <summary>Retracts the device and ends it.</summary>
        public void Dispose() => handle.Dispose();

        /// <summary>
        /// Simulates up to time_s, on any clock that does not go back; the first call says where it begins and places the
        /// finger. Between calls the pose moves straight; a gap of more than a second is skipped. A pose that is none is
        /// taken as lost tracking, and told as InputError.
        /// </summary>
        public Command Step(Pose X_WFt, double time_s)
        {
            var into = new Command();
            Step(X_WFt, time_s, into);
            return into;
        }

        /// <summary>The same with the command in place of the one before: allocates nothing once `into` has been used.</summary>
        public void Step(Pose X_WFt, double time_s, Command into)
        {
            Native.Pose pose = NativePose.Of(X_WFt);
            fixed (Native.Command* to = &command)
            {
                int status = Native.sf_rendering_step(handle, &pose, time_s, to);
                if (status != 0) Native.Check(status, handle);
                into.Take(to);
            }
        }

        /// <summary>The same for all fingers of the scene, in its order; null: tracking of that one is lost.</summary>
        public void StepAll(IReadOnlyList<Pose?> X_WFt, double time_s)
        {
            if (X_WFt == null || X_WFt.Count != Info.FingerCount) throw new InputError($"X_WFt: {Info.FingerCount} poses are wanted");
            Native.Pose* poses = stackalloc Native.Pose[X_WFt.Count];
            int* tracked = stackalloc int[X_WFt.Count];
            for (int i = 0; i < X_WFt.Count; ++i)
            {
                poses[i] = NativePose.Of(X_WFt[i] ?? Pose.Identity);
                tracked[i] = X_WFt[i].HasValue ? 1 : 0;
            }
            Native.Check(Native.sf_rendering_step_fingers(handle, poses, tracked, Native.Size(X_WFt.Count), time_s), handle);
        }

        /// <summary>From here on what tells of a finger or its device, Info too, tells of this one; at first of number 0.</summary>
        public void Select(int finger)
        {
            Native.Check(Native.sf_rendering_select(handle, Native.Size(finger)), handle);
            Info = ReadInfo();
        }

        public string FingerName(int finger) => Native.Text(
            (byte* to, UIntPtr capacity, out UIntPtr count) => Native.sf_rendering_finger_name(handle, Native.Size(finger), to, capacity, out count), check);

        /// <summary>The newest command.</summary>
        public Command NewestCommand()
        {
            var into = new Command();
            fixed (Native.Command* to = &command)
            {
                Native.Check(Native.sf_rendering_command(handle, to), handle);
                into.Take(to);
            }
            return into;
        }

        /// <summary>Tracking is lost, of all fingers: the device holds, after 200 ms it retracts.</summary>
        public Command Lost(double time_s)
        {
            var into = new Command();
            fixed (Native.Command* to = &command)
            {
                Native.Check(Native.sf_rendering_lost(handle, time_s, to), handle);
                into.Take(to);
            }
            return into;
        }

        /// <summary>Retracts the device at once and until it is released, also while nobody steps. From any thread.</summary>
        public void Stop() => Native.Check(Native.sf_rendering_stop(handle), handle);

        /// <summary>Releases it from the stops that the last step told of; Command.Stopped says whether it is. OperationError: nothing is stopped, or it was stopped again since.</summary>
        public void Release() => Native.Check(Native.sf_rendering_release(handle), handle);

        /// <summary>The next line that a person should read of the device, each told once; null: nothing more now.</summary>
        public string TakeMessage()
        {
            var line = new byte[2048];
            fixed (byte* to = line)
            {
                UIntPtr count;
                Native.Check(Native.sf_rendering_take_message(handle, to, Native.Size(line.Length), out count), handle);
            }
            string text = Native.Text(line);
            return text.Length == 0 ? null : text;
        }

        /// <summary>What does not change; of several fingers of the one selected.</summary>
        public RenderingInfo Info { get; private set; }

        /// <summary>Sums of the finger's contact after the last step.</summary>
        public ContactSums Contact()
        {
            var contact = new Native.Contact { size = (uint)sizeof(Native.Contact) };
            Native.Check(Native.sf_rendering_contact(handle, &contact), handle);
            return new ContactSums(&contact);
        }

        /// <summary>Tracked pose after the last step.</summary>
        public Pose X_WFt()
        {
            Native.Pose pose = NativePose.Empty;
            Native.Check(Native.sf_rendering_poses(handle, &pose, null), handle);
            return NativePose.Read(pose);
        }

        /// <summary>Simulated pose after the last step; in contact it stays behind.</summary>
        public Pose X_WF()
        {
            Native.Pose pose = NativePose.Empty;
            Native.Check(Native.sf_rendering_poses(handle, null, &pose), handle);
            return NativePose.Read(pose);
        }

        /// <summary>Deformed skin: x, y, z of each sample in F, m. xyz_F_m: three numbers a sample.</summary>
        public void Positions(double[] xyz_F_m)
        {
            NeedLength(xyz_F_m, 3 * Info.SampleCount, nameof(xyz_F_m));
            UIntPtr count;
            fixed (double* to = xyz_F_m) Native.Check(Native.sf_rendering_positions(handle, to, Native.Size(Info.SampleCount), out count), handle);
        }

        public double[] Positions()
        {
            var xyz_F_m = new double[3 * Info.SampleCount];
            Positions(xyz_F_m);
            return xyz_F_m;
        }

        /// <summary>Pa, one number a sample.</summary>
        public double[] Pressures()
        {
            var pressures_Pa = new double[Info.SampleCount];
            UIntPtr count;
            fixed (double* to = pressures_Pa) Native.Check(Native.sf_rendering_pressures(handle, to, Native.Size(pressures_Pa.Length), out count), handle);
            return pressures_Pa;
        }

        /// <summary>1 where skin around the sample touches, else 0.</summary>
        public byte[] InContact()
        {
            var touches = new byte[Info.SampleCount];
            UIntPtr count;
            fixed (byte* to = touches) Native.Check(Native.sf_rendering_in_contact(handle, to, Native.Size(touches.Length), out count), handle);
            return touches;
        }

        /// <summary>Three samples a triangle, counter-clockwise from outside.</summary>
        public int[] Triangles()
        {
            var corners = new int[3 * Info.TriangleCount];
            UIntPtr count;
            fixed (int* to = corners) Native.Check(Native.sf_rendering_triangles(handle, (uint*)to, Native.Size(Info.TriangleCount), out count), handle);
            return corners;
        }

        public Pose X_WO(int index)
        {
            Native.Pose pose = NativePose.Empty;
            Native.Check(Native.sf_rendering_object_pose(handle, Native.Size(index), &pose), handle);
            return NativePose.Read(pose);
        }

        /// <summary>
        /// Has an object where the caller has it: at the time of the next step, until when it moves straight. It stays where it was put
        /// last; before the first step it is there from the start. Throws InputError of what moves by forces or has something hang on
        /// it by a joint, and while a recording is made.
        /// </summary>
        public void MoveObject(int index, Pose X_WO)
        {
            Native.Pose pose = NativePose.Of(X_WO);
            Native.Check(Native.sf_rendering_move_object(handle, Native.Size(index), &pose), handle);
        }

        public ObjectMotion MotionOf(int index)
        {
            var told = new Native.Object { size = (uint)sizeof(Native.Object) };
            Native.Check(Native.sf_rendering_object(handle, Native.Size(index), &told), handle);
            return new ObjectMotion(&told);
        }

        /// <summary>The surface of something soft as it is deformed: x, y, z of each point in W, m; empty of what keeps its shape.</summary>
        public double[] ObjectPositions(int index)
        {
            UIntPtr count;
            Native.Check(Native.sf_rendering_object_positions(handle, Native.Size(index), null, UIntPtr.Zero, out count), handle);
            var xyz_W_m = new double[3 * (int)count];
            fixed (double* to = xyz_W_m) Native.Check(Native.sf_rendering_object_positions(handle, Native.Size(index), to, count, out count), handle);
            return xyz_W_m;
        }

        /// <summary>Three points of that surface a triangle, counter-clockwise from outside.</summary>
        public int[] ObjectTriangles(int index)
        {
            UIntPtr count;
            Native.Check(Native.sf_rendering_object_triangles(handle, Native.Size(index), null, UIntPtr.Zero, out count), handle);
            var corners = new int[3 * (int)count];
            fixed (int* to = corners) Native.Check(Native.sf_rendering_object_triangles(handle, Native.Size(index), (uint*)to, count, out count), handle);
            return corners;
        }

        /// <summary>The next event of objects that move, each told once; null: nothing more now. Of more than 256 that wait the oldest are forgotten.</summary>
        public ObjectEvent TakeEvent()
        {
            var told = new Native.Event { size = (uint)sizeof(Native.Event) };
            Native.Check(Native.sf_rendering_take_event(handle, &told), handle);
            return told.kind == 0 ? null : new ObjectEvent(told);
        }

        public string ObjectName(int index) => Native.Text(
            (byte* to, UIntPtr capacity, out UIntPtr count) => Native.sf_rendering_object_name(handle, Native.Size(index), to, capacity, out count), check);

        /// <summary>Name of a component of the configuration with the unit people read, e.g. pitch_deg; its value is SI.</summary>
        public string ConfigurationName(int component) => Native.Text(
            (byte* to, UIntPtr capacity, out UIntPtr count) => Native.sf_rendering_configuration_name(handle, Native.Size(component), to, capacity, out count), check);

        /// <summary>Writes what is left of the recording and closes it; steps after that are not recorded.</summary>
        public void CloseRecording()
        {
            byte[] error = Native.NewError();
            Native.Check(Native.sf_rendering_close_recording(handle, error, Native.ErrorSize), error);
        }

        RenderingInfo ReadInfo()
        {
            var info = new Native.Info { size = (uint)sizeof(Native.Info) };
            Native.Check(Native.sf_rendering_info(handle, &info), handle);
            return new RenderingInfo(info);
        }

        static void NeedLength(double[] array, int length, string name)
        {
            if (array == null || array.Length != length) throw new InputError($"{name}: {length} numbers are wanted");
        }
    }
}
