using System;
using System.Collections.Generic;
using System.Reflection;
using System.Threading;
using NUnit.Framework;
using Softfinger;
using Softfinger.Unity;
using Softfinger.Unity.Samples;
using UnityEngine;

/// <summary>The package for Unity against a server or the library: UnityTest CASE WHERE [MORE].</summary>
static class UnityTest
{
    const double Patience_s = 60;

    static int Main(string[] arguments)
    {
        string where = arguments[1], more = arguments.Length > 2 ? arguments[2] : null;
        switch (arguments[0])
        {
            case "frames": return Check.Status(() =>
            {
                OfFrames();
                OfShapes();
            });
            case "show": return Check.Status(() => Show(where));
            case "soft": return Check.Status(() => ShowSoft(where));
            case "events": return Check.Status(() => OfObjects(where));
            case "move": return Check.Status(() => MoveFinger(where));
            case "hand": return Check.Status(() => MoveHand(where));
            case "nobody": return Check.Status(() => Nobody(where));
            case "library": return Check.Status(() => InThisProcess(where, more));
            case "objects": return Check.Status(() => ObjectsInThisProcess(where, more));
            default: throw new ArgumentException(arguments[0]);
        }
    }

    /// <summary>Frames until it holds.</summary>
    static void Until(Func<bool> holds, string what)
    {
        DateTime begin = DateTime.UtcNow;
        do
        {
            if ((DateTime.UtcNow - begin).TotalSeconds > Patience_s) throw new TimeoutException(what);
            World.Frame();
            Thread.Sleep(10);
        }
        while (!holds());
        Check.That(true, what);
    }

    static T Make<T>(Transform parent, params Type[] with) where T : Component, new()
    {
        var made = new GameObject(typeof(T).Name);
        made.SetActive(false);
        made.transform.SetParent(parent, false);
        if (Array.IndexOf(with, typeof(MeshFilter)) >= 0) made.AddComponent<MeshFilter>();
        T component = made.AddComponent<T>();
        made.SetActive(true);
        return component;
    }

    static SoftfingerConnection Connect(string address)
    {
        var made = new GameObject("connection");
        made.SetActive(false);
        var connection = made.AddComponent<SoftfingerConnection>();
        connection.Address = address;
        made.SetActive(true);
        // A scene that lies somewhere, turned: what is relative to it has to be.
        made.transform.localPosition = new Vector3(1, 2, 3);
        made.transform.localRotation = new Quaternion(0, 0.6f, 0, 0.8f);
        return connection;
    }

    /// <summary>Unity's frames here are the library's, to the bit; and the package's own tests pass.</summary>
    static void OfFrames()
    {
        var random = new System.Random(2);
        for (int i = 0; i < 100; ++i)
        {
            double[] q = { random.NextDouble() - 0.5, random.NextDouble() - 0.5, random.NextDouble() - 0.5, random.NextDouble() - 0.5 };
            double length = Math.Sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
            var pose = new Pose(random.NextDouble(), -random.NextDouble(), random.NextDouble(), q[0] / length, q[1] / length, q[2] / length, q[3] / length);
            UnityPose theirs = UnityPose.From(pose);
            Check.Equal(Frames.PositionToUnity(pose), new Vector3((float)theirs.X_m, (float)theirs.Y_m, (float)theirs.Z_m), "position");
            Check.Equal(Frames.RotationToUnity(pose), new Quaternion((float)theirs.Qx, (float)theirs.Qy, (float)theirs.Qz, (float)theirs.Qw), "rotation");
            Pose back = Frames.FromUnity(Frames.PositionToUnity(pose), Frames.RotationToUnity(pose));
            Pose rounded = new Pose((float)pose.X_m, (float)pose.Y_m, (float)pose.Z_m, (float)pose.Qw, (float)pose.Qx, (float)pose.Qy, (float)pose.Qz);
            Check.Equal(back, rounded, "and back");
        }
        int tests = 0;
        foreach (Type type in Assembly.GetExecutingAssembly().GetTypes())
        {
            foreach (MethodInfo method in type.GetMethods())
            {
                if (!Attribute.IsDefined(method, typeof(TestAttribute))) continue;
                method.Invoke(Activator.CreateInstance(type), null);
                ++tests;
            }
        }
        Check.That(tests >= 3, $"{tests} tests of the package");
    }

    /// <summary>Primitives of the sample are as large as the scene's shapes, along the axes of Unity.</summary>
    static void OfShapes()
    {
        Check.Equal(Scale("{\"kind\":\"sphere\",\"radius_mm\":6}"), new Vector3(0.012f, 0.012f, 0.012f), "sphere");
        Check.Equal(Scale("{\"kind\":\"box\",\"size_mm\":[1,2,3],\"edge_radius_mm\":0}"), new Vector3(0.002f, 0.003f, 0.001f), "box");
        Check.Equal(Scale("{\"kind\":\"cylinder\",\"radius_mm\":6,\"length_mm\":30,\"edge_radius_mm\":0}"), new Vector3(0.012f, 0.015f, 0.012f), "cylinder");
        // A corner, whose last side is seen from x, y and z of W.
        GameObject corner = Body("{\"kind\":\"mesh\",\"positions_mm\":[0,0,0,1,0,0,0,1,0,0,0,1],\"triangles\":[0,2,1,0,1,3,0,3,2,1,2,3]}");
        float volume = Volume(corner.GetComponent<MeshFilter>().sharedMesh);
        Check.That(Math.Abs(volume - 1e-9f / 6) < 1e-13f, $"mesh of {volume} m^3");
    }

    static Vector3 Scale(string shape) => Body(shape).transform.localScale;

    static GameObject Body(string shape) => (GameObject)typeof(TouchScene).GetMethod("Body", BindingFlags.Static | BindingFlags.NonPublic)
        .Invoke(null, new object[] { new Shape(Json.Parse(shape, "a shape")) });

    /// <summary>The sample shows finger and object of a scene that a script explores; contact and state come as events.</summary>
    static void Show(string address)
    {
        var root = new GameObject("root");
        root.AddComponent<TouchScene>().Address = address;
        SoftfingerConnection connection = null;
        FingerSkin skin = null;
        ObjectPose thing = null;
        Until(() =>
        {
            connection = connection ?? Find<SoftfingerConnection>();
            skin = Find<FingerSkin>();
            thing = Find<ObjectPose>();
            return skin != null && thing != null && connection.Snapshot != null;
        }, "finger and object");
        Check.That(connection.IsConnected && connection.Scene.Name == "cylinder", "connected");
        int touched = 0, letGo = 0;
        double most_N = 0;
        var states = new List<string>();
        ContactEvents events = Make<ContactEvents>(connection.transform);
        events.Touched.AddListener(() => ++touched);
        events.LetGo.AddListener(() => ++letGo);
        events.NormalForce.AddListener(newtons => most_N = Math.Max(most_N, newtons));
        events.DeviceState.AddListener(states.Add);
        Mesh mesh = skin.GetComponent<MeshFilter>().sharedMesh;
        int[] triangles = mesh.triangles;
        Check.Equal(triangles.Length, connection.Scene.Fingers[0].SkinTriangles.Length, "triangles");
        float rest = Volume(mesh);
        Check.That(rest > 5e-7 && rest < 2e-5, $"clockwise in front: {rest} m^3 of skin");
        Until(() =>
        {
            // Where the script has begun anew these are others.
            skin = Find<FingerSkin>();
            thing = Find<ObjectPose>();
            mesh = skin.GetComponent<MeshFilter>().sharedMesh;
            return most_N > 0.1 && connection.Snapshot != null && connection.Snapshot.Fingers[0].NormalForce_N > 0.1f;
        }, "force");
        Vector3[] vertices = mesh.vertices, before = new Vector3[vertices.Length];
        Check.Equal(3 * vertices.Length, connection.Scene.Fingers[0].SkinPositions_m.Length, "vertices");
        Frames.ToUnity(connection.Scene.Fingers[0].SkinPositions_m, before);
        float moved = 0;
        for (int i = 0; i < vertices.Length; ++i) moved = Math.Max(moved, (vertices[i] - before[i]).magnitude);
        Check.That(moved > 1e-4 && moved < 1e-2, $"skin gives way by {moved} m");
        Check.Equal(mesh.NormalsOf, vertices.Length, "normals");
        FingerSnapshot finger = connection.Snapshot.Fingers[0];
        Check.Equal(skin.transform.localPosition, Frames.PositionToUnity(finger.X_WF), "where the finger is");
        Check.Equal(thing.transform.localPosition, Frames.PositionToUnity(connection.Snapshot.X_WO[0]), "where the object is");
        Check.Equal(thing.transform.localRotation, Frames.RotationToUnity(connection.Snapshot.X_WO[0]), "how it is turned");
        // Pressed skin is redder, and lies on the cylinder, which is along y.
        Color[] colors = mesh.colors;
        float radius_m = (float)connection.Scene.Objects[0].Shape.Radius_m;
        Vector3 axis = thing.transform.localRotation * new Vector3(0, 1, 0);
        Check.That(Math.Abs(axis.x) > 0.99f, "the cylinder lies from left to right");
        int red = 0;
        for (int i = 0; i < colors.Length; ++i)
        {
            if (colors[i].g > 0.6f) continue;
            ++red;
            Vector3 inScene = skin.transform.localPosition + skin.transform.localRotation * vertices[i];
            float off_m = Vector3.Cross(inScene - thing.transform.localPosition, axis).magnitude;
            Check.That(Math.Abs(off_m - radius_m) < 1e-3, $"pressed skin lies on the cylinder: {off_m} m off its axis");
        }
        Check.That(red > 0, "pressed skin");
        Until(() => letGo > 0, "let go");
        // It may have touched already when the first was told, before anyone listened.
        Until(() => touched > 0, "touched");
        Check.That(states.Count > 0 && !string.IsNullOrEmpty(states[0]), "states");
        connection.Stop();
        Until(() => connection.Snapshot.StopConfirmed, "stopped");
        Until(() =>
        {
            connection.Release();
            Thread.Sleep(100);
            return !connection.Snapshot.Stopped;
        }, "released");
        World.End();
        Check.That(!connection.IsConnected, "disconnected");
    }

    /// <summary>The sample shows a sponge that two fingers squeeze: its surface gives way and keeps its volume, nearly.</summary>
    static void ShowSoft(string address)
    {
        var root = new GameObject("root");
        root.AddComponent<TouchScene>().Address = address;
        SoftfingerConnection connection = null;
        SoftObject sponge = null;
        Until(() =>
        {
            connection = connection ?? Find<SoftfingerConnection>();
            sponge = Find<SoftObject>();
            return sponge != null && connection.Snapshot != null;
        }, "sponge");
        Mesh mesh = sponge.GetComponent<MeshFilter>().sharedMesh;
        Shape shape = connection.Scene.Objects[0].Shape;
        Check.Equal(mesh.triangles.Length, shape.Triangles.Length, "triangles");
        var rest = new Vector3[shape.Positions_m.Length / 3];
        Frames.ToUnity(shape.Positions_m, rest);
        float moved = 0;
        Until(() =>
        {
            Vector3[] vertices = mesh.vertices;
            Check.Equal(vertices.Length, rest.Length, "vertices");
            for (int i = 0; i < vertices.Length; ++i) moved = Math.Max(moved, (vertices[i] - rest[i]).magnitude);
            return moved > 1e-3f;
        }, "deformed");
        float volume = Volume(mesh);
        Check.That(volume > 1.5e-5f && volume < 3e-5f, $"clockwise in front: {volume} m^3 of sponge");
        Check.That(moved < 2e-2f, $"by {moved} m");
        Check.Equal(mesh.NormalsOf, rest.Length, "normals");
        World.End();
    }

    /// <summary>A script presses a button: who listens to the button, to the finger on it, to another object.</summary>
    static void OfObjects(string address)
    {
        SoftfingerConnection connection = Connect(address);
        EventsOfObject all = Events(connection, "", ""), button = Events(connection, "button", "index"), finger = Events(connection, "index", "");
        EventsOfObject nobody = Events(connection, "knob", ""), withNobody = Events(connection, "button", "thumb");
        var told = new List<string>();
        double impulse_N_s = 0, pressedAt_N_s = 0;
        connection.Happened += happened =>
        {
            told.Add(happened.Kind);
            Check.Equal(happened.Object, "button", "object");
            Check.That(happened.Time_s > 0, "time");
        };
        int impacts = 0, releases = 0, clicks = 0, fingers = 0, others = 0, ofAll = 0;
        button.Impact.AddListener(newtonSeconds =>
        {
            ++impacts;
            impulse_N_s = newtonSeconds;
        });
        button.Release.AddListener(() => ++releases);
        Events(connection, "button", "").Click.AddListener(newtonSeconds =>
        {
            ++clicks;
            pressedAt_N_s = newtonSeconds;
        });
        all.Impact.AddListener(_ => ++ofAll);
        finger.Impact.AddListener(_ => ++fingers);
        nobody.Impact.AddListener(_ => ++others);
        withNobody.Impact.AddListener(_ => ++others);
        Until(() => told.FindAll(kind => kind == "click").Count >= 2 && told.Contains("impact") && told.Contains("release"), "pressed and let go");
        Check.Equal(impacts, told.FindAll(kind => kind == "impact").Count, "impacts");
        Check.Equal(releases, told.FindAll(kind => kind == "release").Count, "releases");
        Check.Equal(clicks, told.FindAll(kind => kind == "click").Count, "clicks");
        Check.That(impulse_N_s > 0 && !double.IsNaN(pressedAt_N_s), $"{impulse_N_s} and {pressedAt_N_s} N s");
        Check.That(ofAll == impacts && fingers == impacts && others == 0, "each hears of its own");
        World.End();
    }

    static EventsOfObject Events(SoftfingerConnection connection, string of, string other)
    {
        EventsOfObject made = Make<EventsOfObject>(connection.transform);
        made.ObjectName = of;
        made.Other = other;
        return made;
    }

    static T Find<T>() where T : Component
    {
        T found = null;
        foreach (GameObject made in World.All) found = made.activeSelf && made.GetComponent<T>() is T one ? one : found;
        return found;
    }

    /// <summary>By the normals that Unity makes of triangles: positive where they point outward.</summary>
    static float Volume(Mesh mesh)
    {
        Vector3[] vertices = mesh.vertices;
        int[] triangles = mesh.triangles;
        float six = 0;
        for (int i = 0; i < triangles.Length; i += 3)
        {
            six += Vector3.Dot(vertices[triangles[i]], Vector3.Cross(vertices[triangles[i + 1]], vertices[triangles[i + 2]]));
        }
        return six / 6;
    }

    static void MoveFinger(string address)
    {
        SoftfingerConnection connection = Connect(address);
        TrackedFinger tracked = Make<TrackedFinger>(connection.transform);
        tracked.transform.SetParent(null, false);
        var wanted = new Pose(0.003, -0.002, 0.024, 0.96, 0, 0, 0.28);
        Transform origin = connection.transform;
        tracked.transform.position = origin.position + origin.rotation * Frames.PositionToUnity(wanted);
        tracked.transform.rotation = origin.rotation * Frames.RotationToUnity(wanted);
        Until(() => connection.Snapshot != null && Near(connection.Snapshot.Fingers[0].X_WFt, wanted), "the finger is where the transform is");
        Pose there = connection.Snapshot.Fingers[0].X_WFt;
        Check.That(Math.Abs(there.Qw - wanted.Qw) < 1e-5 && Math.Abs(there.Qz - wanted.Qz) < 1e-5, "and turned so");
        tracked.enabled = false;
        Until(() => connection.Snapshot.Fingers[0].DeviceState == "retracting", "lost");
        World.End();
    }

    static bool Near(Pose a, Pose b) => Math.Abs(a.X_m - b.X_m) < 1e-6 && Math.Abs(a.Y_m - b.Y_m) < 1e-6 && Math.Abs(a.Z_m - b.Z_m) < 1e-6;

    static void MoveHand(string address)
    {
        const int Distal = 8, Tip = 9;
        SoftfingerConnection connection = Connect(address);
        TrackedHand hand = Make<TrackedHand>(connection.transform);
        var wanted = new Pose(0.002, 0.001, 0.026, 0.96, 0.1, -0.14, Math.Sqrt(1 - 0.96 * 0.96 - 0.1 * 0.1 - 0.14 * 0.14));
        for (int i = 0; i < Hand.JointCount; ++i)
        {
            hand.Joints[i] = new GameObject("joint").transform;
            hand.Joints[i].SetParent(connection.transform, false);
            // A distal phalanx of 20 mm along its z, which is x of F.
            float ahead_m = i == Distal ? -0.01f : i == Tip ? 0.01f : 0.001f * i;
            hand.Joints[i].localRotation = Frames.RotationToUnity(wanted);
            hand.Joints[i].localPosition = Frames.PositionToUnity(wanted) + ahead_m * (hand.Joints[i].localRotation * Vector3.forward);
        }
        Until(() => connection.Snapshot != null && Near(connection.Snapshot.Fingers[0].X_WFt, wanted), "the finger is where the hand is");
        Pose there = connection.Snapshot.Fingers[0].X_WFt;
        Check.That(Math.Abs(there.Qw - wanted.Qw) < 1e-5 && Math.Abs(there.Qx - wanted.Qx) < 1e-5 && Math.Abs(there.Qy - wanted.Qy) < 1e-5 && Math.Abs(there.Qz - wanted.Qz) < 1e-5, "and turned so");
        hand.Tracked = false;
        Until(() => connection.Snapshot.Fingers[0].DeviceState == "retracting", "lost");
        World.End();
    }

    /// <summary>Where nobody answers one line says so, once.</summary>
    static void Nobody(string address)
    {
        SoftfingerConnection connection = Connect(address);
        var lines = new List<string>();
        connection.Said += lines.Add;
        DateTime begin = DateTime.UtcNow;
        Until(() => (DateTime.UtcNow - begin).TotalSeconds > 3, "three attempts");
        Check.Equal(string.Join("|", lines), address + ": nobody answers: is softfinger running, and its page there?", "lines");
        FingerSkin skin = Make<FingerSkin>(null, typeof(MeshFilter));
        World.Frame();
        Check.That(!skin.enabled && Debug.Errors[0].Contains("no connection: name one, or put it below one"), "a component without a connection");
        World.End();
    }

    static void InThisProcess(string scene, string device)
    {
        var root = new GameObject("root");
        root.SetActive(false);
        var finger = root.AddComponent<LibraryFinger>();
        finger.Scene = scene;
        finger.Device = device;
        root.transform.localPosition = Frames.ToUnity(0, 0, 0.009);
        root.SetActive(true);
        World.Frame();
        Mesh mesh = World.All[1].GetComponent<MeshFilter>().sharedMesh;
        Check.That(Volume(mesh) > 5e-7, $"clockwise in front: {Volume(mesh)} m^3 of skin");
        Until(() =>
        {
            root.transform.localPosition = root.transform.localPosition - new Vector3(0, 2e-5f, 0);
            return finger.NormalForce_N > 0.1f;
        }, "force");
        Check.That(finger.Command.Joints.Length > 0, "a command");
        Check.That(Math.Abs(World.All[1].transform.localPosition.y - root.transform.localPosition.y) < 5e-3f, "the skin is at the finger");
        World.End();
        Check.Equal(Debug.Errors.Count, 0, "errors");
    }

    /// <summary>The table comes up to a finger that stays.</summary>
    static void ObjectsInThisProcess(string scene, string device)
    {
        var root = new GameObject("root");
        root.SetActive(false);
        var table = new GameObject("table");
        table.transform.localPosition = Frames.ToUnity(0, 0, -0.005);
        var finger = root.AddComponent<LibraryFinger>();
        finger.Scene = scene;
        finger.Device = device;
        finger.Objects = new[] { table.transform };
        root.transform.localPosition = Frames.ToUnity(0, 0, 0.009);
        root.SetActive(true);
        World.Frame();
        Check.Equal(finger.NormalForce_N, 0f, "force before");
        Until(() =>
        {
            table.transform.localPosition = table.transform.localPosition + new Vector3(0, 2e-5f, 0);
            return finger.NormalForce_N > 0.1f;
        }, "force");
        World.End();
        Check.Equal(Debug.Errors.Count, 0, "errors");
        table = new GameObject("chair");
        root = new GameObject("again");
        root.SetActive(false);
        finger = root.AddComponent<LibraryFinger>();
        finger.Scene = scene;
        finger.Device = device;
        finger.Objects = new[] { table.transform };
        root.SetActive(true);
        World.Frame();
        Check.That(!finger.enabled && Debug.Errors[0].Contains("no object chair") && Debug.Errors[0].Contains("table"), "an object that there is not");
        World.End();
    }
}
