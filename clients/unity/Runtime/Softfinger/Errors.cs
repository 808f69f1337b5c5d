using System;
using System.Globalization;
using System.Text.RegularExpressions;

namespace Softfinger
{
    /// <summary>Something given from outside is wrong: an address, a file, a key, a pose. One line.</summary>
    public sealed class InputError : Exception
    {
        static readonly Regex Place = new Regex(
            @"^(?<file>[^:]+\.\w+)(:(?<line>\d+))?: ((?<key>[\w.\[\]]+): )?", RegexOptions.CultureInvariant);

        /// <summary>The file that is wrong; null where the message names none.</summary>
        public string File { get; }

        /// <summary>From 1; 0 where the message names none.</summary>
        public int Line { get; }

        /// <summary>Null where the message names none.</summary>
        public string Key { get; }

        public InputError(string message) : base(message)
        {
            System.Text.RegularExpressions.Match place = Place.Match(message);
            if (!place.Success) return;
            File = place.Groups["file"].Value;
            int line;
            if (int.TryParse(place.Groups["line"].Value, NumberStyles.None, CultureInfo.InvariantCulture, out line)) Line = line;
            if (place.Groups["key"].Success) Key = place.Groups["key"].Value;
        }
    }

    /// <summary>The work itself failed: nobody listens, a connection ended, a port cannot be opened. One line.</summary>
    public sealed class OperationError : Exception
    {
        public OperationError(string message) : base(message) { }
    }
}
