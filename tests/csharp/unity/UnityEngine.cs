// As much of UnityEngine as clients/unity uses, with the signatures of Unity's scripting reference, and a World that runs it: enough to
// compile the package and to run it without an editor.
using System;
using System.Collections.Generic;
using System.Reflection;

namespace UnityEngine
{
    [AttributeUsage(AttributeTargets.Field)]
    public sealed class SerializeField : Attribute { }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class TooltipAttribute : Attribute
    {
        public TooltipAttribute(string tooltip) { }
    }

    [AttributeUsage(AttributeTargets.Class)]
    public sealed class AddComponentMenu : Attribute
    {
        public AddComponentMenu(string menuName) { }
    }

    [AttributeUsage(AttributeTargets.Class)]
    public sealed class RequireComponent : Attribute
    {
        public readonly Type Required;
        public RequireComponent(Type requiredComponent) => Required = requiredComponent;
    }

    [AttributeUsage(AttributeTargets.Class)]
    public sealed class DefaultExecutionOrder : Attribute
    {
        public readonly int Order;
        public DefaultExecutionOrder(int order) => Order = order;
    }

    public struct Vector3
    {
        public float x, y, z;

        public Vector3(float x, float y, float z)
        {
            this.x = x;
            this.y = y;
            this.z = z;
        }

        public static Vector3 zero => new Vector3(0, 0, 0);
        public static Vector3 one => new Vector3(1, 1, 1);
        public static Vector3 forward => new Vector3(0, 0, 1);
        public float magnitude => (float)Math.Sqrt(Dot(this, this));
        public static Vector3 operator +(Vector3 a, Vector3 b) => new Vector3(a.x + b.x, a.y + b.y, a.z + b.z);
        public static Vector3 operator -(Vector3 a, Vector3 b) => new Vector3(a.x - b.x, a.y - b.y, a.z - b.z);
        public static Vector3 operator *(float s, Vector3 v) => new Vector3(s * v.x, s * v.y, s * v.z);
        public static float Dot(Vector3 a, Vector3 b) => a.x * b.x + a.y * b.y + a.z * b.z;
        public static Vector3 Cross(Vector3 a, Vector3 b) => new Vector3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    }

    public struct Quaternion
    {
        public float x, y, z, w;

        public Quaternion(float x, float y, float z, float w)
        {
            this.x = x;
            this.y = y;
            this.z = z;
            this.w = w;
        }

        public static Quaternion identity => new Quaternion(0, 0, 0, 1);
        public static Quaternion Inverse(Quaternion q) => new Quaternion(-q.x, -q.y, -q.z, q.w);

        public static Quaternion operator *(Quaternion a, Quaternion b) => new Quaternion(
            a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z);

        public static Vector3 operator *(Quaternion q, Vector3 v)
        {
            var u = new Vector3(q.x, q.y, q.z);
            Vector3 t = 2 * Vector3.Cross(u, v);
            return v + q.w * t + Vector3.Cross(u, t);
        }
    }

    public struct Color
    {
        public float r, g, b, a;

        public Color(float r, float g, float b)
        {
            this.r = r;
            this.g = g;
            this.b = b;
            a = 1;
        }

        public static Color Lerp(Color a, Color b, float t)
        {
            t = Math.Max(0, Math.Min(1, t));
            return new Color(a.r + t * (b.r - a.r), a.g + t * (b.g - a.g), a.b + t * (b.b - a.b));
        }
    }

    public static class Mathf
    {
        public static float Sqrt(float f) => (float)Math.Sqrt(f);
    }

    public static class Time
    {
        static readonly DateTime Begin = DateTime.UtcNow;
        public static float realtimeSinceStartup => (float)(DateTime.UtcNow - Begin).TotalSeconds;
    }

    public static class Debug
    {
        public static readonly List<string> Errors = new List<string>();
        public static void Log(object message) => Console.WriteLine(message);
        public static void LogError(object message) => Errors.Add(message.ToString());
    }

    public class Object
    {
        public string name { get; set; } = "";

        /// <summary>Unity does it at the end of the frame, and null then is what is destroyed.</summary>
        public static void Destroy(Object of)
        {
            if (of is GameObject made) made.SetActive(false);
        }
    }

    public sealed class Material : Object { }

    public sealed class Mesh : Object
    {
        Vector3[] ofVertices = new Vector3[0];
        int[] ofTriangles = new int[0];
        Color[] ofColors = new Color[0];
        public int NormalsOf { get; private set; }

        // Copies, and refused where one does not fit the other, as in Unity.
        public Vector3[] vertices
        {
            get => (Vector3[])ofVertices.Clone();
            set
            {
                foreach (int corner in ofTriangles)
                {
                    if (corner >= value.Length) throw new ArgumentException("fewer vertices than triangles have");
                }
                ofVertices = (Vector3[])value.Clone();
            }
        }

        public int[] triangles
        {
            get => (int[])ofTriangles.Clone();
            set
            {
                foreach (int corner in value)
                {
                    if (corner < 0 || corner >= ofVertices.Length) throw new ArgumentException("a corner that is no vertex");
                }
                ofTriangles = (int[])value.Clone();
            }
        }

        public Color[] colors
        {
            get => (Color[])ofColors.Clone();
            set
            {
                if (value.Length != ofVertices.Length) throw new ArgumentException("as many colours as vertices");
                ofColors = (Color[])value.Clone();
            }
        }

        public void Clear()
        {
            ofVertices = new Vector3[0];
            ofTriangles = new int[0];
            ofColors = new Color[0];
        }

        public void MarkDynamic() { }
        public void RecalculateBounds() { }
        public void RecalculateNormals() => NormalsOf = ofVertices.Length;
    }

    public class Component : Object
    {
        public GameObject gameObject { get; internal set; }
        public Transform transform => gameObject.transform;
        public T GetComponent<T>() => gameObject.GetComponent<T>();

        public T GetComponentInParent<T>()
        {
            for (Transform at = transform; at != null; at = at.parent)
            {
                T found = at.gameObject.GetComponent<T>();
                if (found != null) return found;
            }
            return default(T);
        }
    }

    public class Behaviour : Component
    {
        public bool enabled { get; set; } = true;
    }

    public class MonoBehaviour : Behaviour { }

    public sealed class MeshFilter : Component
    {
        public Mesh sharedMesh { get; set; }
    }

    public sealed class MeshRenderer : Component
    {
        public Material sharedMaterial { get; set; }
    }

    public sealed class Transform : Component
    {
        public Transform parent { get; private set; }
        public Vector3 localPosition { get; set; }
        public Quaternion localRotation { get; set; } = Quaternion.identity;
        public Vector3 localScale { get; set; } = Vector3.one;

        public Vector3 position
        {
            get => parent == null ? localPosition : parent.position + parent.rotation * localPosition;
            set => localPosition = parent == null ? value : parent.InverseTransformPoint(value);
        }

        public Quaternion rotation
        {
            get => parent == null ? localRotation : parent.rotation * localRotation;
            set => localRotation = parent == null ? value : Quaternion.Inverse(parent.rotation) * value;
        }

        public void SetParent(Transform parent, bool worldPositionStays) => this.parent = parent;
        public Vector3 InverseTransformPoint(Vector3 point) => Quaternion.Inverse(rotation) * (point - position);
    }

    public enum PrimitiveType
    {
        Sphere,
        Capsule,
        Cylinder,
        Cube,
        Plane,
    }

    public sealed class GameObject : Object
    {
        readonly List<Component> components = new List<Component>();
        public Transform transform { get; }
        public bool activeSelf { get; private set; } = true;

        public GameObject(string name)
        {
            this.name = name;
            transform = AddComponent<Transform>();
            World.All.Add(this);
        }

        public static GameObject CreatePrimitive(PrimitiveType type)
        {
            var made = new GameObject(type.ToString());
            made.AddComponent<MeshFilter>();
            made.AddComponent<MeshRenderer>();
            return made;
        }

        public T AddComponent<T>() where T : Component, new()
        {
            foreach (RequireComponent required in typeof(T).GetCustomAttributes(typeof(RequireComponent), true))
            {
                if (!components.Exists(one => required.Required.IsInstanceOfType(one))) throw new Exception($"{typeof(T).Name} needs {required.Required.Name}");
            }
            var component = new T { gameObject = this, name = name };
            components.Add(component);
            World.Settle();
            return component;
        }

        public T GetComponent<T>() => (T)(object)components.Find(one => one is T);

        public void SetActive(bool value)
        {
            activeSelf = value;
            World.Settle();
        }

        internal bool IsActive => activeSelf && (transform.parent == null || transform.parent.gameObject.IsActive);
        internal IEnumerable<Behaviour> Behaviours => components.ConvertAll(one => one as Behaviour).FindAll(one => one != null);
    }

    namespace Events
    {
        public class UnityEvent
        {
            event Action Listeners;
            public void AddListener(Action call) => Listeners += call;
            public void Invoke() => Listeners?.Invoke();
        }

        public class UnityEvent<T>
        {
            event Action<T> Listeners;
            public void AddListener(Action<T> call) => Listeners += call;
            public void Invoke(T value) => Listeners?.Invoke(value);
        }
    }

    /// <summary>What an editor in play mode does: OnEnable, Start, Update and OnDisable, in the order of execution.</summary>
    public static class World
    {
        internal static readonly List<GameObject> All = new List<GameObject>();
        static readonly HashSet<Behaviour> Enabled = new HashSet<Behaviour>(), Started = new HashSet<Behaviour>();

        public static void Frame()
        {
            Settle();
            foreach (Behaviour one in Ordered())
            {
                if (Enabled.Contains(one) && Started.Add(one)) Call(one, "Start");
            }
            Settle();
            foreach (Behaviour one in Ordered())
            {
                if (Enabled.Contains(one)) Call(one, "Update");
            }
        }

        /// <summary>The end of play mode.</summary>
        public static void End()
        {
            foreach (GameObject made in All) made.SetActive(false);
            Settle();
            All.Clear();
        }

        /// <summary>Unity calls OnEnable and OnDisable at once.</summary>
        internal static void Settle()
        {
            foreach (Behaviour one in Ordered())
            {
                bool active = one.enabled && one.gameObject.IsActive;
                if (active && Enabled.Add(one)) Call(one, "OnEnable");
                if (!active && Enabled.Remove(one)) Call(one, "OnDisable");
            }
        }

        static List<Behaviour> Ordered()
        {
            var all = new List<Behaviour>();
            foreach (GameObject made in All) all.AddRange(made.Behaviours);
            var order = new List<int>(all.ConvertAll(OrderOf));
            // Of equals the first stays first.
            var sorted = new List<Behaviour>();
            foreach (int rank in new SortedSet<int>(order)) sorted.AddRange(all.FindAll(one => OrderOf(one) == rank));
            return sorted;
        }

        static int OrderOf(Behaviour one) => ((DefaultExecutionOrder)Attribute.GetCustomAttribute(one.GetType(), typeof(DefaultExecutionOrder)))?.Order ?? 0;

        static void Call(Behaviour one, string name)
        {
            for (Type type = one.GetType(); type != typeof(MonoBehaviour); type = type.BaseType)
            {
                MethodInfo method = type.GetMethod(name, BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic | BindingFlags.DeclaredOnly);
                if (method == null) continue;
                method.Invoke(one, null);
                return;
            }
        }
    }
}

namespace NUnit.Framework
{
    [AttributeUsage(AttributeTargets.Method)]
    public sealed class TestAttribute : Attribute { }

    public static class Assert
    {
        public static void AreEqual(object wanted, object found) => Check.Equal(found, wanted, "NUnit");
        public static void AreEqual(double wanted, double found, double delta) => Check.That(Math.Abs(found - wanted) <= delta, $"NUnit: {found} instead of {wanted}");
    }
}
