// An exploration by the library in C#, recorded; as explore.c.
using System.IO;
using Softfinger;

static class Explore
{
    static int Main(string[] arguments)
    {
        var options = new RenderingOptions { Device = arguments[1], Recording = arguments[3] };
        using (var rendering = new Rendering(arguments[0], options))
        using (var motion = new BinaryReader(File.OpenRead(arguments[2])))
        {
            var row = new double[8];
            while (motion.BaseStream.Position < motion.BaseStream.Length)
            {
                for (int i = 0; i < row.Length; ++i) row[i] = motion.ReadDouble();
                rendering.Step(new Pose(row[1], row[2], row[3], row[4], row[5], row[6], row[7]), row[0]);
            }
            rendering.CloseRecording();
        }
        return 0;
    }
}
