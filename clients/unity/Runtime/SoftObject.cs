using UnityEngine;

namespace Softfinger.Unity
{
    /// <summary>The surface of a soft object as a mesh, as it is deformed; where it lies, an ObjectPose on it or above it says.</summary>
    [RequireComponent(typeof(MeshFilter))]
    [AddComponentMenu("softfinger/Soft Object")]
    public sealed class SoftObject : ConnectedBehaviour
    {
        [SerializeField, Tooltip("Of the scene; empty: its first that is soft")]
        string objectName = "";

        int index = -1;
        Mesh mesh;
        Vector3[] vertices = new Vector3[0];

        public string ObjectName
        {
            get => objectName;
            set => objectName = value;
        }

        protected override void OnScene(Scene scene)
        {
            if (mesh == null)
            {
                mesh = new Mesh { name = "softfinger soft object" };
                mesh.MarkDynamic();
                GetComponent<MeshFilter>().sharedMesh = mesh;
            }
            mesh.Clear();
            index = -1;
            for (int i = 0; i < scene.Objects.Count && index < 0; ++i)
            {
                SceneObject of = scene.Objects[i];
                if (of.Shape.Kind == "soft" && (objectName.Length == 0 || of.Name == objectName)) index = i;
            }
            if (index < 0) return;
            Shape rest = scene.Objects[index].Shape;
            vertices = new Vector3[rest.Positions_m.Length / 3];
            Show(rest.Positions_m);
            mesh.triangles = Frames.TrianglesToUnity(rest.Triangles);
            mesh.RecalculateNormals();
        }

        protected override void OnSnapshot(Snapshot snapshot)
        {
            foreach (SoftObjectSnapshot of in snapshot.SoftObjects)
            {
                if (of.Object != index || of.Positions_m.Length != 3 * vertices.Length) continue;
                Show(of.Positions_m);
                mesh.RecalculateNormals();
            }
        }

        void Show(float[] positions_m)
        {
            Frames.ToUnity(positions_m, vertices);
            mesh.vertices = vertices;
            mesh.RecalculateBounds();
        }

        void OnDestroy()
        {
            if (mesh != null) Destroy(mesh);
        }
    }
}
