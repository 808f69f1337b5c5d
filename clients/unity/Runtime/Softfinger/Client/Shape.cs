namespace Softfinger
{
    /// <summary>An object's, or a piece's of a device. Zero or null is what its kind does not have.</summary>
    public sealed class Shape
    {
        /// <summary>plane (z = 0 of O, solid below), sphere, box, cylinder (along z of O), mesh, or soft: a mesh at rest.</summary>
        public string Kind { get; }

        /// <summary>Of a sphere or cylinder.</summary>
        public double Radius_m { get; }

        /// <summary>Of a cylinder.</summary>
        public double Length_m { get; }

        /// <summary>Of a box or cylinder.</summary>
        public double EdgeRadius_m { get; }

        /// <summary>Three whole edges of a box.</summary>
        public double[] Size_m { get; }

        /// <summary>Of a mesh, or soft: x, y, z of each vertex in O.</summary>
        public float[] Positions_m { get; }

        /// <summary>Of a mesh, or soft: three vertices a triangle, counter-clockwise from outside.</summary>
        public int[] Triangles { get; }

        internal Shape(Json json)
        {
            Kind = json["kind"].Text();
            Radius_m = Length(json, "radius_mm");
            Length_m = Length(json, "length_mm");
            EdgeRadius_m = Length(json, "edge_radius_mm");
            if (json.Has("size_mm"))
            {
                Size_m = json["size_mm"].Array(edge => 1e-3 * edge.Number());
                if (Size_m.Length != 3) throw json["size_mm"].Wanted("three numbers");
            }
            if (json.Has("positions_mm"))
            {
                Positions_m = Geometry.Positions(json["positions_mm"]);
                Triangles = Geometry.Triangles(json["triangles"], Positions_m);
            }
        }

        static double Length(Json json, string key) => json.Has(key) ? 1e-3 * json[key].Number() : 0;
    }

    /// <summary>Lists of vertices and triangles as messages have them.</summary>
    internal static class Geometry
    {
        public static float[] Positions(Json json)
        {
            float[] positions_m = json.Array(coordinate => (float)(1e-3 * coordinate.Number()));
            if (positions_m.Length % 3 != 0) throw json.Wanted("three numbers a vertex");
            return positions_m;
        }

        public static int[] Triangles(Json json, float[] positions_m)
        {
            // Of no vertices there are no triangles: 0 is refused by the length alone.
            int last = positions_m.Length / 3 - 1;
            int[] corners = json.Array(corner => (int)corner.Count(last));
            if (corners.Length % 3 != 0) throw json.Wanted("three vertices a triangle");
            return corners;
        }
    }
}
