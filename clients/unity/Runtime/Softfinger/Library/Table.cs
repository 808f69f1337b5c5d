using System;
using System.Collections.Generic;

namespace Softfinger
{
    /// <summary>A result in columns; names with their units as the command line has them, a missing value is NaN.</summary>
    public sealed class Table
    {
        readonly Dictionary<string, double[]> columns = new Dictionary<string, double[]>();

        /// <summary>In the command line's order.</summary>
        public IReadOnlyList<string> Names { get; }

        public int Rows { get; }

        /// <summary>All of the result as the command prints it with --json.</summary>
        public string Json { get; }

        /// <summary>A column by its name.</summary>
        public double[] this[string name]
        {
            get
            {
                double[] column;
                if (columns.TryGetValue(name, out column)) return column;
                throw new InputError($"no column {name}: there is {string.Join(", ", Names)}");
            }
        }

        internal unsafe Table(IntPtr made)
        {
            using (var handle = new TableHandle(made))
            {
                UIntPtr rows, count;
                Check(Native.sf_table_size(handle, out rows, out count));
                Rows = (int)rows;
                var names = new List<string>();
                for (int column = 0; column < (int)count; ++column)
                {
                    UIntPtr index = Native.Size(column), written;
                    names.Add(Native.Text((byte* to, UIntPtr capacity, out UIntPtr needed) => Native.sf_table_name(handle, index, to, capacity, out needed), Check));
                    var values = new double[Rows];
                    fixed (double* to = values) Check(Native.sf_table_column(handle, index, to, rows, out written));
                    columns.Add(names[column], values);
                }
                Names = names;
                Json = Native.Text((byte* to, UIntPtr capacity, out UIntPtr needed) => Native.sf_table_text(handle, to, capacity, out needed), Check);
            }
        }

        static void Check(int status) => Native.Check(status, "a table: no such column");
    }
}
