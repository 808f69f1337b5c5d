using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Softfinger
{
    /// <summary>libsoftfinger.so.0 as softfinger.h declares it, and what it refuses as exceptions.</summary>
    internal static unsafe class Native
    {
        public const int MostComponents = 256;
        const string Library = "libsoftfinger.so.0";
        const int ErrorBytes = 2048;
        const int Done = 0, Failed = 1;

        [StructLayout(LayoutKind.Sequential)]
        public struct Options
        {
            public uint size;
            public IntPtr finger;
            public IntPtr device;
            public int open_device;
            public int unused;
            public IntPtr guard_program;
            public IntPtr person;
            public IntPtr recording;
            public int record_state;
            public int filter;
            public double predict_s;
            public int all_fingers;
            public int threads;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Pose
        {
            public uint size;
            public fixed double position_m[3];
            public fixed double quaternion_wxyz[4];
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct UnityPose
        {
            public uint size;
            public fixed double position_m[3];
            public fixed double quaternion_xyzw[4];
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Command
        {
            public uint size;
            public uint configuration_count;
            public uint joint_count;
            public int state;
            public long tick;
            public double time_s;
            public double deviation_m2;
            public fixed double configuration[MostComponents];
            public fixed double joints[MostComponents];
            public int stopped;
            public int stop_confirmed;
            public uint stops;
            public uint set_point_count;
            public fixed double set_points[MostComponents];
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Contact
        {
            public uint size;
            public uint samples_in_contact;
            public double time_s;
            public double normal_force_N;
            public double tangential_force_N;
            public double contact_area_m2;
            public fixed double centroid_F_m[3];
            public fixed double mean_normal_F[3];
            public double normal_force_sum_N;
            public double slip_ratio;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Info
        {
            public uint size;
            public uint sample_count;
            public uint triangle_count;
            public uint object_count;
            public uint configuration_count;
            public uint joint_count;
            public double simulation_rate_Hz;
            public double device_rate_Hz;
            public uint finger_count;
            public uint unused;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Object
        {
            public uint size;
            public int moves;
            public int has_joint;
            public int soft;
            public double joint;
            public fixed double velocity_m_per_s[3];
            public fixed double angular_velocity_rad_per_s[3];
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Event
        {
            public uint size;
            public int kind;
            public double time_s;
            public double impulse_N_s;
            public uint @object;
            public int other_object;
            public int other_finger;
            public int unused;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct PressOptions
        {
            public uint size;
            public int rows;
            public double depth_m;
            public double sphere_radius_m;
            public fixed double at_m[2];
            public int edge;
            public int no_strain_limits;
            public double edge_radius_m;
            public int no_friction;
            public int relaxed;
            public double pitch_rad;
            public double speed_m_per_s;
            public double hold_s;
            public int unload;
            public int unused;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct EvaluateOptions
        {
            public uint size;
            public IntPtr device;
            public IntPtr wearer;
            public IntPtr objective;
            public IntPtr person;
            public double duration_s;
            public IntPtr stop;
            public IntPtr progress;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct RunOptions
        {
            public uint size;
            public int record_state;
            public IntPtr device;
            public IntPtr wearer;
            public IntPtr person;
            public IntPtr recording;
            public double duration_s;
            public double predict_s;
            public int filter;
            public int threads;
            public IntPtr stop;
            public IntPtr progress;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct DeviceInfo
        {
            public uint size;
            public uint configuration_count;
            public uint joint_count;
            public int joints_are_linear;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Points
        {
            public uint size;
            public uint count;
            public double* points_F_m;
            public byte* in_contact;
            public double* areas_m2;
            public double* gaps_m;
            public double separation_m;
            public int limits;
            public int unused;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Match
        {
            public uint size;
            public uint configuration_count;
            public uint joint_count;
            public int joints_exist;
            public int iterations;
            public int termination;
            public double deviation_m2;
            public fixed double configuration[MostComponents];
            public fixed double joints[MostComponents];
        }

        [DllImport(Library)] public static extern uint sf_version();
        [DllImport(Library)] public static extern int sf_scene_finger(byte[] scene, UIntPtr index, byte* name, UIntPtr capacity, out UIntPtr count, byte[] error, UIntPtr errorSize);

        [DllImport(Library)] public static extern int sf_rendering_create(byte[] scene, Options* options, out IntPtr rendering, byte[] error, UIntPtr errorSize);
        [DllImport(Library)] public static extern void sf_rendering_destroy(IntPtr rendering);
        [DllImport(Library)] public static extern int sf_rendering_message(RenderingHandle rendering, byte[] text, UIntPtr capacity);
        [DllImport(Library)] public static extern int sf_rendering_step(RenderingHandle rendering, Pose* X_WFt, double time_s, Command* command);
        [DllImport(Library)] public static extern int sf_rendering_lost(RenderingHandle rendering, double time_s, Command* command);
        [DllImport(Library)] public static extern int sf_rendering_step_fingers(RenderingHandle rendering, Pose* X_WFt, int* tracked, UIntPtr count, double time_s);
        [DllImport(Library)] public static extern int sf_rendering_select(RenderingHandle rendering, UIntPtr finger);
        [DllImport(Library)] public static extern int sf_rendering_command(RenderingHandle rendering, Command* command);
        [DllImport(Library)] public static extern int sf_rendering_object(RenderingHandle rendering, UIntPtr index, Object* told);
        [DllImport(Library)] public static extern int sf_rendering_object_positions(RenderingHandle rendering, UIntPtr index, double* xyz_W_m, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] public static extern int sf_rendering_object_triangles(RenderingHandle rendering, UIntPtr index, uint* corners, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] public static extern int sf_rendering_take_event(RenderingHandle rendering, Event* told);
        [DllImport(Library)] public static extern int sf_rendering_finger_name(RenderingHandle rendering, UIntPtr finger, byte* name, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] public static extern int sf_rendering_stop(RenderingHandle rendering);
        [DllImport(Library)] public static extern int sf_rendering_release(RenderingHandle rendering);
        [DllImport(Library)] public static extern int sf_rendering_take_message(RenderingHandle rendering, byte* text, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] public static extern int sf_rendering_info(RenderingHandle rendering, Info* info);
        [DllImport(Library)] public static extern int sf_rendering_contact(RenderingHandle rendering, Contact* contact);
        [DllImport(Library)] public static extern int sf_rendering_poses(RenderingHandle rendering, Pose* X_WFt, Pose* X_WF);
        [DllImport(Library)] public static extern int sf_rendering_positions(RenderingHandle rendering, double* xyz_F_m, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] public static extern int sf_rendering_pressures(RenderingHandle rendering, double* pressures_Pa, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] public static extern int sf_rendering_in_contact(RenderingHandle rendering, byte* in_contact, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] public static extern int sf_rendering_triangles(RenderingHandle rendering, uint* corners, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] public static extern int sf_rendering_object_pose(RenderingHandle rendering, UIntPtr index, Pose* X_WO);
        [DllImport(Library)] public static extern int sf_rendering_move_object(RenderingHandle rendering, UIntPtr index, Pose* X_WO);
        [DllImport(Library)] public static extern int sf_rendering_object_name(RenderingHandle rendering, UIntPtr index, byte* name, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] public static extern int sf_rendering_configuration_name(RenderingHandle rendering, UIntPtr component, byte* name, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] public static extern int sf_rendering_close_recording(RenderingHandle rendering, byte[] error, UIntPtr errorSize);

        [DllImport(Library)] public static extern int sf_pose_to_unity(Pose* pose, UnityPose* unity);
        [DllImport(Library)] public static extern int sf_pose_from_unity(UnityPose* unity, Pose* pose);

        [DllImport(Library)] public static extern void sf_table_destroy(IntPtr table);
        [DllImport(Library)] public static extern int sf_table_size(TableHandle table, out UIntPtr rows, out UIntPtr columns);
        [DllImport(Library)] public static extern int sf_table_name(TableHandle table, UIntPtr column, byte* name, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] public static extern int sf_table_column(TableHandle table, UIntPtr column, double* values, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] public static extern int sf_table_text(TableHandle table, byte* text, UIntPtr capacity, out UIntPtr count);

        [DllImport(Library)] public static extern int sf_press(byte[] finger, PressOptions* options, out IntPtr table, byte[] error, UIntPtr errorSize);
        [DllImport(Library)] public static extern int sf_evaluate(byte[] scene, EvaluateOptions* options, out IntPtr table, byte[] error, UIntPtr errorSize);
        [DllImport(Library)] public static extern int sf_run(byte[] scene, RunOptions* options, out IntPtr table, byte[] error, UIntPtr errorSize);
        [DllImport(Library)] public static extern int sf_recording_export(byte[] recording, byte[] folder, byte[] note, UIntPtr capacity, byte[] error, UIntPtr errorSize);
        [DllImport(Library)] public static extern int sf_recording_replay(byte[] recording, out int agree, byte[] difference, UIntPtr capacity, byte[] error, UIntPtr errorSize);

        [DllImport(Library)] public static extern int sf_device_create(byte[] file, out IntPtr device, byte[] error, UIntPtr errorSize);
        [DllImport(Library)] public static extern void sf_device_destroy(IntPtr device);
        [DllImport(Library)] public static extern int sf_device_describe(DeviceHandle device, DeviceInfo* info);
        [DllImport(Library)] public static extern int sf_device_show(DeviceHandle device, byte* text, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] public static extern int sf_device_component(DeviceHandle device, UIntPtr component, byte[] name, UIntPtr capacity, out double unit);
        [DllImport(Library)] public static extern int sf_device_home(DeviceHandle device, double* configuration, UIntPtr count);
        [DllImport(Library)] public static extern int sf_device_solve(DeviceHandle device, double[] configuration, UIntPtr configurationCount, double[] joints, UIntPtr jointCount, out int closes, out int reachable);
        [DllImport(Library)] public static extern int sf_device_pose(DeviceHandle device, double[] joints, UIntPtr jointCount, double[] configuration, UIntPtr configurationCount);
        [DllImport(Library)] public static extern int sf_device_match(DeviceHandle device, Points* points, Match* match);
        [DllImport(Library)] public static extern int sf_device_message(DeviceHandle device, byte[] text, UIntPtr capacity);

        /// <summary>Throws OperationError where the library is not there, or of a version whose interface is another.</summary>
        public static void Need()
        {
            uint version;
            try
            {
                version = sf_version();
            }
            catch (Exception failure) when (failure is DllNotFoundException || failure is EntryPointNotFoundException || failure is BadImageFormatException)
            {
                throw new OperationError($"{Library} is not found, or cannot be loaded: install it, or name its folder in LD_LIBRARY_PATH");
            }
            if (version >> 16 != 0) throw new OperationError($"{Library} is of version {version >> 16}, this is for version 0");
        }

        public static UIntPtr Size(int size) => (UIntPtr)(uint)size;

        /// <summary>Room for the line of a call that makes something.</summary>
        public static byte[] NewError() => new byte[ErrorBytes];

        public static UIntPtr ErrorSize => Size(ErrorBytes);

        public static void Check(int status, byte[] message)
        {
            if (status == Done) return;
            if (status == Failed) throw new OperationError(Text(message));
            throw new InputError(Text(message));
        }

        public static void Check(int status, RenderingHandle rendering)
        {
            if (status == Done) return;
            byte[] message = NewError();
            sf_rendering_message(rendering, message, ErrorSize);
            Check(status, message);
        }

        public static void Check(int status, DeviceHandle device)
        {
            if (status == Done) return;
            byte[] message = NewError();
            sf_device_message(device, message, ErrorSize);
            Check(status, message);
        }

        /// <summary>Of a call that has no message: its arguments are this file's alone.</summary>
        public static void Check(int status, string what)
        {
            if (status != Done) throw new InputError(what);
        }

        public delegate int TextCall(byte* to, UIntPtr capacity, out UIntPtr count);

        /// <summary>Text of a call with a capacity in bytes: asked once for its size, then for itself.</summary>
        public static string Text(TextCall call, Action<int> check)
        {
            UIntPtr count;
            check(call(null, UIntPtr.Zero, out count));
            var text = new byte[(int)count];
            fixed (byte* to = text) check(call(to, count, out count));
            return Text(text);
        }

        /// <summary>Up to the terminating zero.</summary>
        public static string Text(byte[] utf8)
        {
            int length = Array.IndexOf(utf8, (byte)0);
            return Encoding.UTF8.GetString(utf8, 0, length < 0 ? utf8.Length : length);
        }

        /// <summary>UTF-8 with a terminating zero; null stays null.</summary>
        public static byte[] Utf8(string text)
        {
            if (text == null) return null;
            if (text.IndexOf('\0') >= 0) throw new InputError($"\"{text.Replace("\0", "\\0")}\": no character of it may be zero");
            var bytes = new byte[Encoding.UTF8.GetByteCount(text) + 1];
            Encoding.UTF8.GetBytes(text, 0, text.Length, bytes, 0);
            return bytes;
        }

        public static double[] Copy(double* from, uint count)
        {
            var values = new double[Math.Min(count, MostComponents)];
            for (int i = 0; i < values.Length; ++i) values[i] = from[i];
            return values;
        }
    }
}
