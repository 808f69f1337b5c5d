using System;
using System.Runtime.InteropServices;

namespace Softfinger
{
    // A handle stays alive while a call is in it, and ends once, however its owner ends.

    internal sealed class RenderingHandle : SafeHandle
    {
        public RenderingHandle(IntPtr rendering) : base(IntPtr.Zero, true) => SetHandle(rendering);
        public override bool IsInvalid => handle == IntPtr.Zero;

        protected override bool ReleaseHandle()
        {
            Native.sf_rendering_destroy(handle);
            return true;
        }
    }

    internal sealed class TableHandle : SafeHandle
    {
        public TableHandle(IntPtr table) : base(IntPtr.Zero, true) => SetHandle(table);
        public override bool IsInvalid => handle == IntPtr.Zero;

        protected override bool ReleaseHandle()
        {
            Native.sf_table_destroy(handle);
            return true;
        }
    }

    internal sealed class DeviceHandle : SafeHandle
    {
        public DeviceHandle(IntPtr device) : base(IntPtr.Zero, true) => SetHandle(device);
        public override bool IsInvalid => handle == IntPtr.Zero;

        protected override bool ReleaseHandle()
        {
            Native.sf_device_destroy(handle);
            return true;
        }
    }

    /// <summary>A text where the library can read it while it is called.</summary>
    internal sealed class NativeText : IDisposable
    {
        public IntPtr Pointer { get; private set; }

        public NativeText(string text)
        {
            byte[] bytes = Native.Utf8(text);
            if (bytes == null) return;
            Pointer = Marshal.AllocHGlobal(bytes.Length);
            Marshal.Copy(bytes, 0, Pointer, bytes.Length);
        }

        public void Dispose()
        {
            Marshal.FreeHGlobal(Pointer);
            Pointer = IntPtr.Zero;
        }
    }
}
