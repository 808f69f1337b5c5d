using UnityEngine;

namespace Softfinger.Unity
{
    /// <summary>The deformed skin of a finger as a mesh, this object where the simulated finger is in the scene.</summary>
    [RequireComponent(typeof(MeshFilter))]
    [AddComponentMenu("softfinger/Finger Skin")]
    public sealed class FingerSkin : ConnectedBehaviour
    {
        [SerializeField, Tooltip("Empty: the first of the scene")]
        string finger = "";

        [SerializeField, Tooltip("The second finger, that the device presses")]
        bool twin = false;

        [SerializeField]
        Color skin = new Color(0.91f, 0.73f, 0.63f);

        [SerializeField, Tooltip("Of skin under the pressure below")]
        Color pressed = new Color(0.8f, 0.1f, 0.1f);

        [SerializeField, Tooltip("Pa")]
        float fullPressure_Pa = 10000;

        Mesh mesh;
        Vector3[] vertices = new Vector3[0];
        Color[] colors = new Color[0];

        public string Finger
        {
            get => finger;
            set => finger = value;
        }

        public bool Twin
        {
            get => twin;
            set => twin = value;
        }

        protected override void OnScene(Scene scene)
        {
            int index = Connection.FingerNamed(finger);
            if (mesh == null)
            {
                mesh = new Mesh { name = "softfinger skin" };
                mesh.MarkDynamic();
                GetComponent<MeshFilter>().sharedMesh = mesh;
            }
            mesh.Clear();
            if (index < 0) return;
            SceneFinger of = scene.Fingers[index];
            vertices = new Vector3[of.SkinPositions_m.Length / 3];
            colors = new Color[vertices.Length];
            for (int i = 0; i < colors.Length; ++i) colors[i] = skin;
            Frames.ToUnity(of.SkinPositions_m, vertices);
            Show();
            mesh.triangles = Frames.TrianglesToUnity(of.SkinTriangles);
            mesh.RecalculateNormals();
        }

        protected override void OnSnapshot(Snapshot snapshot)
        {
            int index = Connection.FingerNamed(finger);
            if (index < 0) return;
            FingerSnapshot of = snapshot.Fingers[index];
            Frames.Place(transform, of.X_WF);
            Skin shown = twin ? of.Twin : (Skin)of;
            if (shown == null || shown.Positions_m.Length != 3 * vertices.Length) return;
            Frames.ToUnity(shown.Positions_m, vertices);
            for (int i = 0; i < colors.Length; ++i) colors[i] = Color.Lerp(skin, pressed, shown.Pressures_Pa[i] / fullPressure_Pa);
            Show();
            mesh.RecalculateNormals();
        }

        void Show()
        {
            mesh.vertices = vertices;
            mesh.colors = colors;
            mesh.RecalculateBounds();
        }

        void OnDestroy()
        {
            if (mesh != null) Destroy(mesh);
        }
    }
}
