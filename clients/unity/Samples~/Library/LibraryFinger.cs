using UnityEngine;

namespace Softfinger.Unity.Samples
{
    /// <summary>
    /// A finger that is simulated here, by libsoftfinger.so.0 on Linux: it follows this object, its skin is a mesh of a child. The
    /// scene's origin is this object's parent, as it is of those that lead objects of the scene.
    /// </summary>
    public sealed class LibraryFinger : MonoBehaviour
    {
        [SerializeField, Tooltip("A scene file")]
        string scene = "";

        [SerializeField, Tooltip("A device file; empty: the scene's")]
        string device = "";

        [SerializeField, Tooltip("Commands are sent, not only formed")]
        bool openDevice = false;

        [SerializeField, Tooltip("Siblings of this, each of the name of an object of the scene, which is where it is")]
        Transform[] objects = new Transform[0];

        Rendering rendering;
        Mesh mesh;
        Transform skin;
        double[] positions_m;
        Vector3[] vertices;
        string[] names;
        int[] led;
        readonly Command command = new Command();

        public string Scene
        {
            get => scene;
            set => scene = value;
        }

        public string Device
        {
            get => device;
            set => device = value;
        }

        /// <summary>Siblings of this, each of the name of an object of the scene, which is where it is.</summary>
        public Transform[] Objects
        {
            get => objects;
            set => objects = value;
        }

        /// <summary>What the device is told; of the last step.</summary>
        public Command Command => command;

        /// <summary>N, of the last step.</summary>
        public float NormalForce_N { get; private set; }

        void OnEnable()
        {
            try
            {
                rendering = new Rendering(scene, new RenderingOptions { Device = device.Length > 0 ? device : null, OpenDevice = openDevice });
            }
            catch (System.Exception error) when (error is InputError || error is OperationError)
            {
                Fail(error.Message);
                return;
            }
            names = new string[rendering.Info.ObjectCount];
            for (int i = 0; i < names.Length; ++i) names[i] = rendering.ObjectName(i);
            led = System.Array.ConvertAll(objects, one => System.Array.IndexOf(names, one.gameObject.name));
            var shown = new GameObject("skin");
            skin = shown.transform;
            skin.SetParent(transform.parent, false);
            mesh = new Mesh();
            mesh.MarkDynamic();
            shown.AddComponent<MeshFilter>().sharedMesh = mesh;
            shown.AddComponent<MeshRenderer>();
            positions_m = rendering.Positions();
            vertices = new Vector3[positions_m.Length / 3];
            Show();
            mesh.triangles = Frames.TrianglesToUnity(rendering.Triangles());
        }

        void Fail(string why)
        {
            Debug.LogError("softfinger: " + why);
            enabled = false;
        }

        /// <summary>Has the scene's objects where theirs are now.</summary>
        bool LeadObjects()
        {
            try
            {
                for (int i = 0; i < led.Length; ++i)
                {
                    if (led[i] < 0) throw new InputError($"no object {objects[i].gameObject.name} in {scene}: there is {string.Join(", ", names)}");
                    rendering.MoveObject(led[i], Frames.FromUnity(objects[i].localPosition, objects[i].localRotation));
                }
                return true;
            }
            catch (InputError error)
            {
                Fail(error.Message);
                return false;
            }
        }

        void Update()
        {
            if (!LeadObjects()) return;
            Pose X_WFt = Frames.FromUnity(transform.localPosition, transform.localRotation);
            rendering.Step(X_WFt, Time.realtimeSinceStartup, command);
            NormalForce_N = (float)rendering.Contact().NormalForce_N;
            rendering.Positions(positions_m);
            Frames.Place(skin, rendering.X_WF());
            Show();
            mesh.RecalculateNormals();
        }

        void Show()
        {
            for (int i = 0; i < vertices.Length; ++i)
            {
                vertices[i] = Frames.ToUnity(positions_m[3 * i], positions_m[3 * i + 1], positions_m[3 * i + 2]);
            }
            mesh.vertices = vertices;
            mesh.RecalculateBounds();
        }

        /// <summary>Retracts the device.</summary>
        void OnDisable()
        {
            rendering?.Dispose();
            rendering = null;
            if (skin != null) Destroy(skin.gameObject);
            if (mesh != null) Destroy(mesh);
        }
    }
}
