using System;
using System.Collections.Generic;

namespace Softfinger
{
    /// <summary>What stays the same while a scene runs. SI units; snapshots of the same generation belong to it.</summary>
    public sealed class Scene : Message
    {
        /// <summary>Of the protocol; 1 where the program does not say.</summary>
        public int Protocol { get; }

        /// <summary>Grows with each scene or restart.</summary>
        public long Generation { get; }

        /// <summary>e.g. sphere.</summary>
        public string Name { get; }

        /// <summary>What Client.ChooseSceneAsync may choose from.</summary>
        public IReadOnlyList<string> Scenes { get; }

        /// <summary>0: endless.</summary>
        public double Duration_s { get; }

        public IReadOnlyList<SceneObject> Objects { get; }
        public IReadOnlyList<SceneFinger> Fingers { get; }

        /// <summary>What a person should know of a finger's device before it moves.</summary>
        public IReadOnlyList<Notice> Notices { get; }

        /// <summary>What a device can be led by.</summary>
        public IReadOnlyList<Named> Objectives { get; }

        /// <summary>Stages on the way from a finger to the servos, as FingerSnapshot.Stages_s has them.</summary>
        public IReadOnlyList<Named> LatencyStages { get; }

        internal Scene(Json json)
        {
            Protocol = json.Has("protocol_version") ? (int)json["protocol_version"].Count(int.MaxValue) : 1;
            if (Protocol != Client.Protocol)
            {
                throw new OperationError($"the program speaks protocol {Protocol}, this client {Client.Protocol}: take both from one version of softfinger");
            }
            Generation = json["generation"].Count();
            Name = json["scene"].Text();
            Scenes = json["scenes"].Array(scene => scene.Text());
            Duration_s = json["duration_s"].Number();
            Objects = json["objects"].Array(of => new SceneObject(of));
            Fingers = json["fingers"].Array(of => new SceneFinger(of));
            Notices = json["notices"].Array(of => new Notice(of));
            Objectives = json["objectives"].Array(of => new Named(of));
            LatencyStages = json["latency_stages"].Array(of => new Named(of));
        }
    }

    public sealed class SceneObject
    {
        public string Name { get; }
        public Shape Shape { get; }

        /// <summary>Whose bone it is; null: nobody's.</summary>
        public string Hand { get; }

        /// <summary>Moves by the forces on it: Client.HoldAsync takes it.</summary>
        public bool Holdable { get; }

        /// <summary>Kind of the joint it moves by: slider, hinge, ball or fixed; null: none.</summary>
        public string Joint { get; }

        internal SceneObject(Json json)
        {
            Holdable = json["holdable"].Bool();
            Joint = json["joint"].IsNull ? null : json["joint"].Text();
            Name = json["name"].Text();
            Shape = new Shape(json["shape"]);
            Hand = json["hand"].IsNull ? null : json["hand"].Text();
        }
    }

    public sealed class SceneFinger
    {
        public string Name { get; }

        /// <summary>Skin at rest: x, y, z of each sample in F, m.</summary>
        public float[] SkinPositions_m { get; }

        /// <summary>Three samples a triangle, counter-clockwise from outside.</summary>
        public int[] SkinTriangles { get; }

        /// <summary>Of bone and nail: x, y, z of each vertex in F, m.</summary>
        public float[] RigidPositions_m { get; }

        public int[] BoneTriangles { get; }
        public int[] NailTriangles { get; }

        /// <summary>Empty: no device. Beside it what people call it.</summary>
        public string DeviceKind { get; }

        public string DeviceKindWords { get; }

        /// <summary>With the unit people read, e.g. pitch_deg; FingerSnapshot.Configuration is SI.</summary>
        public IReadOnlyList<string> ConfigurationNames { get; }

        /// <summary>Places in Scene.Objectives of those that the device can have.</summary>
        public int[] Objectives { get; }

        /// <summary>Joints are m, else rad.</summary>
        public bool JointsAreLinear { get; }

        public double DiskRadius_m { get; }
        public int Legs { get; }

        /// <summary>Of the device's solid, one each of FingerSnapshot.Pieces.</summary>
        public IReadOnlyList<Shape> Pieces { get; }

        /// <summary>Whether snapshots may have a twin.</summary>
        public bool Twin { get; }

        /// <summary>Its tracker is page: Client.SendPoseAsync moves it.</summary>
        public bool MovedHere { get; }

        /// <summary>Its tracker's body can be registered, for the person whose file was given.</summary>
        public bool Registrable { get; }

        /// <summary>Its device can learn who wears it, for the same person: Client.FitAsync.</summary>
        public bool Fittable { get; }

        /// <summary>The wearer tells each touch: the device has no force sensor.</summary>
        public bool FitsByTouch { get; }

        /// <summary>Its tracker is webxr: Client.SendHandAsync moves it. Null: not so.</summary>
        public FollowedFinger Headset { get; }

        /// <summary>To SI, of each component of the configuration.</summary>
        internal double[] ConfigurationScales { get; }

        const int MostPieces = 100000;

        internal SceneFinger(Json json)
        {
            Name = json["name"].Text();
            SkinPositions_m = Geometry.Positions(json["skin_positions_mm"]);
            SkinTriangles = Geometry.Triangles(json["skin_triangles"], SkinPositions_m);
            RigidPositions_m = Geometry.Positions(json["rigid_positions_mm"]);
            BoneTriangles = Geometry.Triangles(json["bone_triangles"], RigidPositions_m);
            NailTriangles = Geometry.Triangles(json["nail_triangles"], RigidPositions_m);
            DeviceKind = json["device_kind"].Text();
            DeviceKindWords = json["device_kind_words"].Text();
            ConfigurationNames = json["configuration_names"].Array(name => name.Text());
            Objectives = json["objectives"].Array(place => (int)place.Count(int.MaxValue));
            JointsAreLinear = json["joint_unit"].Text() == "mm";
            DiskRadius_m = 1e-3 * json["disk_radius_mm"].Number();
            Legs = (int)json["legs"].Count(int.MaxValue);
            Pieces = ReadPieces(json["pieces"]);
            Twin = json["twin"].Bool();
            MovedHere = json["moved_here"].Bool();
            Registrable = json["registrable"].Bool();
            Fittable = json["fittable"].Bool();
            FitsByTouch = json["fits_by_touch"].Bool();
            Headset = json["headset"].IsNull ? null : new FollowedFinger(json["headset"]);
            ConfigurationScales = new double[ConfigurationNames.Count];
            for (int i = 0; i < ConfigurationScales.Length; ++i) ConfigurationScales[i] = ScaleOf(ConfigurationNames[i]);
        }

        static double ScaleOf(string name) =>
            name.EndsWith("_deg", StringComparison.Ordinal) ? Math.PI / 180 :
            name.EndsWith("_mm", StringComparison.Ordinal) ? 1e-3 : 1;

        static List<Shape> ReadPieces(Json runs)
        {
            var pieces = new List<Shape>();
            foreach (Json run in runs.List())
            {
                var shape = new Shape(run["shape"]);
                for (long left = run["count"].Count(MostPieces - pieces.Count); left > 0; --left) pieces.Add(shape);
            }
            return pieces;
        }
    }

    /// <summary>What a finger follows of a hand that a headset sees.</summary>
    public sealed class FollowedFinger
    {
        public bool LeftHand { get; }

        /// <summary>thumb, index, middle, ring or pinky.</summary>
        public string Finger { get; }

        /// <summary>Where the scene begins it.</summary>
        public Pose X_WFt_Start { get; }

        internal FollowedFinger(Json json)
        {
            LeftHand = json["hand"].Text() == "left";
            Finger = json["finger"].Text();
            double[] start = json["start"].Array(part => part.Number());
            if (start.Length != 7) throw json["start"].Wanted("seven numbers");
            X_WFt_Start = new Pose(1e-3 * start[0], 1e-3 * start[1], 1e-3 * start[2], start[6], start[3], start[4], start[5]);
        }
    }

    public sealed class Notice
    {
        /// <summary>Of the scene's.</summary>
        public int Finger { get; }

        /// <summary>One word for what it is about, e.g. force_limit.</summary>
        public string Kind { get; }

        public string Text { get; }

        internal Notice(Json json)
        {
            Finger = (int)json["finger"].Count(int.MaxValue);
            Kind = json["kind"].Text();
            Text = json["text"].Text();
        }
    }

    /// <summary>A name, and what people call it.</summary>
    public sealed class Named
    {
        public string Name { get; }
        public string Words { get; }

        internal Named(Json json)
        {
            Name = json["name"].Text();
            Words = json["words"].Text();
        }
    }
}
