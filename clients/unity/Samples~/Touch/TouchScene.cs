using System.Collections.Generic;
using UnityEngine;

namespace Softfinger.Unity.Samples
{
    /// <summary>Shows whatever scene a running softfinger explores. On an empty object; needs nothing else.</summary>
    public sealed class TouchScene : MonoBehaviour
    {
        [SerializeField]
        string address = "http://127.0.0.1:8080";

        [SerializeField, Tooltip("Of objects; the default shader's where empty")]
        Material objectMaterial = null;

        [SerializeField, Tooltip("Shows vertex colours, for the skin")]
        Material skinMaterial = null;

        readonly List<GameObject> shown = new List<GameObject>();
        SoftfingerConnection connection;

        public string Address
        {
            get => address;
            set => address = value;
        }

        void Start()
        {
            var scene = new GameObject("softfinger");
            scene.transform.SetParent(transform, false);
            scene.SetActive(false);
            connection = scene.AddComponent<SoftfingerConnection>();
            connection.Address = address;
            connection.SceneBegan += Show;
            scene.SetActive(true);
        }

        void Show(Scene scene)
        {
            foreach (GameObject old in shown) Destroy(old);
            shown.Clear();
            foreach (SceneObject described in scene.Objects)
            {
                GameObject made = Made(described.Name);
                made.AddComponent<ObjectPose>().ObjectName = described.Name;
                GameObject body = Body(described.Shape);
                body.transform.SetParent(made.transform, false);
                if (described.Shape.Kind == "soft") body.AddComponent<SoftObject>().ObjectName = described.Name;
                if (objectMaterial != null) body.GetComponent<MeshRenderer>().sharedMaterial = objectMaterial;
                made.SetActive(true);
            }
            foreach (SceneFinger described in scene.Fingers)
            {
                GameObject made = Made(described.Name);
                made.AddComponent<MeshFilter>();
                made.AddComponent<MeshRenderer>().sharedMaterial = skinMaterial;
                made.AddComponent<FingerSkin>().Finger = described.Name;
                made.SetActive(true);
            }
        }

        GameObject Made(string name)
        {
            var made = new GameObject(name);
            made.SetActive(false);
            made.transform.SetParent(connection.transform, false);
            shown.Add(made);
            return made;
        }

        /// <summary>Unity's primitives have sizes of their own: balls and boxes of 1, cylinders 2 long and 1 thick, planes 10 wide.</summary>
        static GameObject Body(Shape shape)
        {
            GameObject body;
            switch (shape.Kind)
            {
                case "sphere":
                    body = GameObject.CreatePrimitive(PrimitiveType.Sphere);
                    body.transform.localScale = 2 * (float)shape.Radius_m * Vector3.one;
                    return body;
                case "box":
                    body = GameObject.CreatePrimitive(PrimitiveType.Cube);
                    body.transform.localScale = new Vector3((float)shape.Size_m[1], (float)shape.Size_m[2], (float)shape.Size_m[0]);
                    return body;
                case "cylinder":
                    body = GameObject.CreatePrimitive(PrimitiveType.Cylinder);
                    body.transform.localScale = new Vector3(2 * (float)shape.Radius_m, (float)shape.Length_m / 2, 2 * (float)shape.Radius_m);
                    return body;
                case "soft":
                    body = new GameObject("soft");
                    body.AddComponent<MeshFilter>();
                    body.AddComponent<MeshRenderer>();
                    return body;
                case "mesh":
                    body = new GameObject("mesh");
                    var vertices = new Vector3[shape.Positions_m.Length / 3];
                    Frames.ToUnity(shape.Positions_m, vertices);
                    var mesh = new Mesh { vertices = vertices, triangles = Frames.TrianglesToUnity(shape.Triangles) };
                    mesh.RecalculateNormals();
                    body.AddComponent<MeshFilter>().sharedMesh = mesh;
                    body.AddComponent<MeshRenderer>();
                    return body;
                default:
                    body = GameObject.CreatePrimitive(PrimitiveType.Plane);
                    body.transform.localScale = 0.01f * Vector3.one;
                    return body;
            }
        }
    }
}
