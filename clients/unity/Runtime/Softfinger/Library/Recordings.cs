namespace Softfinger
{
    /// <summary>Recordings, as the command line makes them and RenderingOptions.Recording.</summary>
    public static class Recordings
    {
        /// <summary>Writes one as CSV files in a new folder. Gives a line where the recording was cut, else null.</summary>
        public static string Export(string recording, string folder)
        {
            Native.Need();
            byte[] from = Native.Utf8(recording), to = Native.Utf8(folder), note = new byte[2048];
            byte[] error = Native.NewError();
            Native.Check(Native.sf_recording_export(from, to, note, Native.Size(note.Length), error, Native.ErrorSize), error);
            return NullIfEmpty(note);
        }

        /// <summary>Runs one again with its recorded input. Null: every bit is the same; else where it is not.</summary>
        public static string Replay(string recording)
        {
            Native.Need();
            byte[] from = Native.Utf8(recording), difference = new byte[2048];
            int agree = 0;
            byte[] error = Native.NewError();
            Native.Check(Native.sf_recording_replay(from, out agree, difference, Native.Size(difference.Length), error, Native.ErrorSize), error);
            return agree != 0 ? null : NullIfEmpty(difference) ?? "it differs";
        }

        static string NullIfEmpty(byte[] text) => text[0] == 0 ? null : Native.Text(text);
    }
}
