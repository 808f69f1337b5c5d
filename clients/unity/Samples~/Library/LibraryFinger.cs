using UnityEngine;

namespace Softfinger.Unity.Samples
{
    /// <summary>
    /// A finger that is simulated here, by libsoftfinger.so.0 on Linux: it follows this object, its skin is a mesh of a child. The
    /// scene's origin is this object's parent.
    /// </summary>
    public sealed class LibraryFinger : MonoBehaviour
    {
        [SerializeField, Tooltip("A scene file")]
        string scene = "";

        [SerializeField, Tooltip("A device file; empty: the scene's")]
        string device = "";

        [SerializeField, Tooltip("Commands are sent, not only formed")]
        bool openDevice = false;

        Rendering rendering;
        Mesh mesh;
        Transform skin;
        double[] positions_m;
        Vector3[] vertices;
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
                Debug.LogError("softfinger: " + error.Message);
                enabled = false;
                return;
            }
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

        void Update()
        {
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
