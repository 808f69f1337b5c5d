using System;
using System.Collections.Generic;
using System.Globalization;
using System.Net.WebSockets;
using System.Threading;
using System.Threading.Tasks;
using Softfinger;

/// <summary>The client against a server: ClientTest CASE ADDRESS [MORE].</summary>
static class ClientTest
{
    const int Patience_ms = 60000;

    static int Main(string[] arguments)
    {
        string address = arguments[1];
        switch (arguments[0])
        {
            case "watch": return Check.Status(() => Watch(address));
            case "move": return Check.Status(() => Move(address));
            case "stop": return Check.Status(() => Stop(address));
            case "hand": return Check.Status(() => HandMoves(address));
            case "hold": return Check.Status(() => Holds(address));
            case "choose": return Check.Status(() => Choose(address));
            case "token": return Check.Status(() => Token(address, arguments[2]));
            case "refuse": return Check.Status(() => Refuse(address));
            case "events": return Check.Status(() => Clicks(address));
            case "soft": return Check.Status(() => GivesWay(address));
            case "fit": return Check.Status(() => Learns(address));
            case "answer": return Check.Status(() => Answer(address, arguments[2]));
            case "spoil": return Check.Status(() => Spoil(address));
            default: throw new ArgumentException(arguments[0]);
        }
    }

    static Client Connect(string address) => Wait(Client.ConnectAsync(address));

    static T Wait<T>(Task<T> task)
    {
        if (Task.WaitAny(new Task[] { task }, Patience_ms) < 0) throw new TimeoutException("nothing came");
        return task.GetAwaiter().GetResult();
    }

    static void Wait(Task task) => task.GetAwaiter().GetResult();

    /// <summary>The first message of this kind for which that holds.</summary>
    static T Until<T>(Client client, Func<T, bool> holds) where T : Message
    {
        DateTime begin = DateTime.UtcNow;
        string told = "";
        while ((DateTime.UtcNow - begin).TotalMilliseconds < Patience_ms)
        {
            Message message = Wait(client.ReceiveAsync());
            if (message == null) throw new Exception("the connection ended");
            if (message is Notifications notifications) told += string.Join("; ", notifications.Lines);
            if (message is T wanted && holds(wanted)) return wanted;
        }
        throw new TimeoutException($"no such {typeof(T).Name}; told meanwhile: {told}");
    }

    /// <summary>Prints of every snapshot what a recording has of its step, until enough have come.</summary>
    static void Watch(string address)
    {
        using (Client client = Connect(address))
        {
            SceneFinger described = client.Scene.Fingers[0];
            Check.Equal(client.Scene.Name, "plane", "scene");
            Check.Equal(client.Scene.Protocol, Client.Protocol, "protocol");
            Check.Equal(client.Scene.Objects[0].Shape.Kind, "plane", "shape");
            Check.Equal(described.Name, "index", "finger");
            Check.Equal(string.Join(" ", described.ConfigurationNames), "pitch_deg roll_deg travel_mm", "configuration");
            Check.That(!described.JointsAreLinear && !described.MovedHere && described.Headset == null, "a thimble moved by a script");
            int samples = described.SkinPositions_m.Length / 3;
            // A closed surface, but for what the nail covers: about twice as many triangles as samples.
            Check.That(described.SkinTriangles.Length > 3 * samples && samples > 50, "skin");
            Check.That(described.BoneTriangles.Length > 0 && described.NailTriangles.Length > 0 && described.Pieces.Count > 0, "bone, nail and device");
            int snapshots = 0, pressed = 0, twins = 0;
            double time_s = -1;
            while (snapshots < 20 || pressed < 10 || twins < 1)
            {
                Message message = Wait(client.ReceiveAsync());
                Check.That(message != null, $"{snapshots} snapshots, {pressed} with force, {twins} with a twin, then the connection ended");
                if (!(message is Snapshot snapshot)) continue;
                ++snapshots;
                FingerSnapshot finger = snapshot.Fingers[0];
                Check.That(snapshot.Time_s >= time_s, "time goes on");
                Check.Equal(finger.Positions_m.Length, 3 * samples, "samples");
                Check.Equal(finger.Stages_s.Length, client.Scene.LatencyStages.Count, "stages");
                Check.Equal(snapshot.X_WO.Count, 1, "objects");
                foreach (float coordinate in finger.Positions_m) Check.That(Math.Abs(coordinate) < 0.03, "skin is near the bone");
                int touching = 0;
                double pressure = 0;
                for (int i = 0; i < samples; ++i)
                {
                    touching += finger.InContact[i];
                    pressure = Math.Max(pressure, finger.Pressures_Pa[i]);
                }
                Check.Equal(touching > 0, finger.NormalForce_N > 0, "who touches is pressed");
                Check.Equal(pressure > 0, finger.NormalForce_N > 0, "and under pressure");
                Check.That(pressure < 1e5, "of skin, in Pa");
                time_s = snapshot.Time_s;
                if (finger.NormalForce_N > 0.1) ++pressed;
                if (finger.Twin != null && finger.Twin.NormalForce_N > 0.01) twins += Touched(finger.Twin, samples);
                Print(snapshot);
            }
        }
    }

    /// <summary>A finger meets a button, which snaps: both come as they happen, each once.</summary>
    static void Clicks(string address)
    {
        using (Client client = Connect(address))
        {
            var heard = new List<ObjectEvents.Event>();
            long generation = -1;
            Until<ObjectEvents>(client, told =>
            {
                Check.Equal(told.Generation, client.Scene.Generation, "generation");
                if (told.Generation != generation) heard.Clear();
                generation = told.Generation;
                // Who comes late hears the click of a press whose impact was before.
                foreach (ObjectEvents.Event one in told.Events)
                {
                    if (heard.Count > 0 || one.Kind == "impact") heard.Add(one);
                }
                return heard.Exists(one => one.Kind == "click");
            });
            ObjectEvents.Event impact = heard.Find(one => one.Kind == "impact"), click = heard.Find(one => one.Kind == "click");
            Check.That(impact.Object == "button" && impact.Other == "index" && impact.Impulse_N_s > 0, $"{impact.Object} and {impact.Other}");
            Check.That(click.Object == "button" && click.Other == null && click.Time_s > impact.Time_s, "click");
        }
    }

    /// <summary>The uppermost block is lifted off the tower and falls; the table is not taken.</summary>
    static void Holds(string address)
    {
        using (Client client = Connect(address))
        {
            int at = 0;
            while (client.Scene.Objects[at].Name != "block_5") ++at;
            Check.That(client.Scene.Objects[at].Holdable, "a block");
            Check.Throws<InputError>(() => Wait(client.HoldAsync("table", new Pose())), "no object table that can be held");
            double height = 0;
            DateTime begin = DateTime.UtcNow;
            while (height < 0.12 && (DateTime.UtcNow - begin).TotalMilliseconds < Patience_ms)
            {
                Wait(client.HoldAsync("block_5", new Pose(0, 0.05, 0.13)));
                height = Until<Snapshot>(client, snapshot => true).X_WO[at].Z_m;
            }
            Check.That(height >= 0.12, $"lifted to {height} m");
            Wait(client.LetGoAsync("block_5"));
            Until<Snapshot>(client, snapshot => snapshot.X_WO[at].Z_m < 0.06);
        }
    }

    /// <summary>The sponge between two fingers is pressed out of its shape, by less than it is thick.</summary>
    static void GivesWay(string address)
    {
        using (Client client = Connect(address))
        {
            Check.Equal(client.Scene.Objects[0].Shape.Kind, "soft", "shape");
            float[] rest = client.Scene.Objects[0].Shape.Positions_m;
            Snapshot pressed = Until<Snapshot>(client, snapshot => snapshot.Fingers[0].NormalForce_N > 0.3f && snapshot.Fingers[1].NormalForce_N > 0.3f);
            Check.Equal(pressed.SoftObjects.Count, 1, "soft objects");
            Check.Equal(pressed.SoftObjects[0].Object, 0, "which");
            float[] now = pressed.SoftObjects[0].Positions_m;
            Check.Equal(now.Length, rest.Length, "points");
            float most = 0;
            for (int i = 0; i < rest.Length; ++i) most = Math.Max(most, Math.Abs(now[i] - rest[i]));
            Check.That(most > 1e-3f && most < 2e-2f, $"gives way by {most} m");
        }
    }

    /// <summary>1, of a twin that is pressed as skin is.</summary>
    static int Touched(Twin twin, int samples)
    {
        Check.Equal(twin.Positions_m.Length, 3 * samples, "samples of the twin");
        Check.That(twin.NormalForce_N < 5 && twin.ContactArea_m2 > 1e-6 && twin.ContactArea_m2 < 4e-4, "force and area of the twin");
        Check.That(twin.Iou >= 0 && twin.Iou <= 1 && twin.CentroidShift_m >= 0 && twin.CentroidShift_m < 0.02, "measures of the twin");
        Check.That(twin.NormalForceSum_N >= twin.NormalForce_N * 0.999f && twin.Press_s > 0 && twin.Press_s < 1, "press of the twin");
        Check.That(Array.IndexOf(twin.InContact, (byte)1) >= 0, "contact of the twin");
        return 1;
    }

    static void Print(Snapshot snapshot)
    {
        FingerSnapshot finger = snapshot.Fingers[0];
        var columns = new List<double>
        {
            snapshot.Step, snapshot.Time_s, finger.NormalForce_N, finger.TangentialForce_N, finger.ContactArea_m2, finger.NormalForceSum_N, finger.SlipRatio,
            finger.X_WF.X_m, finger.X_WF.Y_m, finger.X_WF.Z_m, finger.X_WF.Qw, finger.X_WF.Qx, finger.X_WF.Qy, finger.X_WF.Qz,
            finger.Tick, finger.Deviation_m2, finger.Configuration[0], finger.Configuration[1], finger.Configuration[2],
            finger.Joints[0], finger.Joints[1], finger.Joints[2],
        };
        Console.WriteLine(string.Join(" ", columns.ConvertAll(number => number.ToString("R", CultureInfo.InvariantCulture))) + " " + finger.DeviceState);
    }

    /// <summary>A finger whose tracker is page goes where it is sent, turned as it is sent, and touches.</summary>
    static void Move(string address)
    {
        using (Client client = Connect(address))
        {
            Check.That(client.Scene.Fingers[0].MovedHere, "moved here");
            double half = Math.PI / 36;
            var aside = new Pose(-0.004, 0.003, 0.021, Math.Cos(half), 0, 0, Math.Sin(half));
            Pose reached;
            using (Keep(() => client.SendPoseAsync(0, aside)))
            {
                reached = Until<Snapshot>(client, snapshot => Distance(snapshot.Fingers[0].X_WF, aside) < 1e-4).Fingers[0].X_WFt;
            }
            Check.That(Distance(reached, aside) < 1e-6 && Math.Abs(reached.Qz - Math.Sin(half)) < 1e-6 && Math.Abs(reached.Qw - Math.Cos(half)) < 1e-6, "as sent");
            using (Keep(() => client.SendPoseAsync(0, new Pose(0, 0, 0.006))))
            {
                // The simulated finger stays behind.
                Until<Snapshot>(client, snapshot => snapshot.Fingers[0].NormalForce_N > 0.2 && snapshot.Fingers[0].X_WF.Z_m > 0.0061);
                Until<Snapshot>(client, snapshot => snapshot.Fingers[0].DeviceState == "rendering");
            }
            Until<Snapshot>(client, snapshot => snapshot.Fingers[0].DeviceState == "retracting");
        }
    }

    /// <summary>Sends again and again, as a tracker does, until it is disposed.</summary>
    static IDisposable Keep(Func<Task> send) => new Sender(send);

    sealed class Sender : IDisposable
    {
        readonly CancellationTokenSource end = new CancellationTokenSource();
        readonly Task sending;

        public Sender(Func<Task> send)
        {
            sending = Task.Run(async () =>
            {
                while (!end.IsCancellationRequested)
                {
                    await send();
                    await Task.Delay(16);
                }
            });
        }

        public void Dispose()
        {
            end.Cancel();
            Wait(sending);
        }
    }

    static double Distance(Pose a, Pose b) =>
        Math.Sqrt(Math.Pow(a.X_m - b.X_m, 2) + Math.Pow(a.Y_m - b.Y_m, 2) + Math.Pow(a.Z_m - b.Z_m, 2));

    /// <summary>A stop holds until it is released from the stop that a snapshot told of, not from one before.</summary>
    static void Stop(string address)
    {
        using (Client client = Connect(address))
        using (Keep(() => client.SendPoseAsync(0, new Pose(0, 0, 0.021))))
        {
            Snapshot before = Until<Snapshot>(client, snapshot => snapshot.Fingers[0].DeviceState == "ready" || snapshot.Fingers[0].DeviceState == "rendering");
            Check.That(!before.Stopped && !before.StopConfirmed, "not stopped");
            Wait(client.StopAsync());
            Snapshot stopped = Until<Snapshot>(client, snapshot => snapshot.StopConfirmed);
            Check.That(stopped.Stopped && stopped.Stops > before.Stops, "stopped once more");
            Until<Snapshot>(client, snapshot => snapshot.Fingers[0].DeviceState == "retracting");
            Wait(client.ReleaseAsync(before));
            Wait(client.PauseAsync());
            Check.That(Until<Snapshot>(client, snapshot => snapshot.Paused).Stopped, "released by what was before the stop");
            Wait(client.ResumeAsync());
            uint asked = 0;
            Until<Snapshot>(client, snapshot =>
            {
                // Refused while the device has not been led away.
                if (snapshot.Stopped && !snapshot.Paused && snapshot.Step - asked > 200)
                {
                    asked = snapshot.Step;
                    Wait(client.ReleaseAsync(snapshot));
                }
                return !snapshot.Stopped;
            });
        }
    }

    /// <summary>A finger whose tracker is webxr follows the hand that is sent, and is lost with it.</summary>
    static void HandMoves(string address)
    {
        using (Client client = Connect(address))
        {
            FollowedFinger followed = client.Scene.Fingers[0].Headset;
            Check.That(followed != null && !followed.LeftHand && followed.Finger == "index", "the right index finger");
            Pose start = followed.X_WFt_Start;
            Check.That(Math.Abs(start.Z_m - 0.03) < 0.02 && start.Qw > 0.9, "near the plane");
            var wanted = new Pose(0.002, -0.003, 0.024);
            Hand hand = HandAt(wanted);
            DateTime begin = DateTime.UtcNow;
            using (Keep(() =>
            {
                hand.Time_s = (DateTime.UtcNow - begin).TotalSeconds;
                return client.SendHandAsync(hand);
            }))
            {
                FingerSnapshot there = Until<Snapshot>(client, snapshot => Distance(snapshot.Fingers[0].X_WFt, wanted) < 1e-5).Fingers[0];
                Check.That(there.X_WFt.Qw > 0.9999, "turned as the world");
            }
            hand.Tracked = false;
            Wait(client.SendHandAsync(hand));
            Until<Snapshot>(client, snapshot => snapshot.Fingers[0].DeviceState == "retracting");
        }
    }

    /// <summary>An index finger whose distal phalanx is 20 mm long and lies as W does, its middle where it is wanted.</summary>
    static Hand HandAt(Pose X_WFt)
    {
        const int Distal = 8, Tip = 9;
        var hand = new Hand { Tracked = true };
        for (int i = 0; i < Hand.JointCount; ++i) hand.Joints[i] = new HandJoint { Pose = new Pose(0.01 * i, 0.1, 0.1), Radius_m = 0.008f };
        for (int i = Distal; i <= Tip; ++i)
        {
            double ahead_m = i == Distal ? -0.01 : 0.01;
            // x_W = -z, y_W = -x, z_W = y of the headset's space.
            hand.Joints[i].Pose = new Pose(-X_WFt.Y_m, X_WFt.Z_m, -(X_WFt.X_m + ahead_m));
        }
        return hand;
    }

    static void Choose(string address)
    {
        using (Client client = Connect(address))
        {
            long before = client.Scene.Generation;
            Check.Throws<InputError>(() => client.ChooseSceneAsync("nowhere"), "no scene nowhere: there is");
            Check.Throws<InputError>(() => client.ChooseObjectiveAsync(0, "nothing"), "no objective nothing: there is");
            Check.Throws<InputError>(() => client.ChooseObjectiveAsync(7, client.Scene.Objectives[0].Name), "no finger 7: the scene has 1");
            int other = Array.Find(client.Scene.Fingers[0].Objectives, place => client.Scene.Objectives[place].Name == "contact_surface" || place > 0);
            Wait(client.ChooseObjectiveAsync(0, client.Scene.Objectives[other].Name));
            Until<Snapshot>(client, snapshot => snapshot.Fingers[0].Objective == other);
            Wait(client.ChooseSceneAsync("sphere"));
            Check.Equal(Until<Loading>(client, loading => loading.Scene != "").Scene, "sphere", "loading");
            Scene sphere = Until<Scene>(client, scene => true);
            Check.That(sphere.Generation > before && sphere == client.Scene, "a new generation");
            Check.Equal(sphere.Name, "sphere", "scene");
            Check.Equal(sphere.Objects[0].Shape.Kind, "sphere", "shape");
            Check.That(sphere.Objects[0].Shape.Radius_m > 1e-3 && sphere.Objects[0].Shape.Radius_m < 0.1, "radius");
            Check.Equal(Until<Snapshot>(client, snapshot => true).Generation, (uint)sphere.Generation, "snapshots of it");
        }
    }

    static void Token(string address, string without)
    {
        using (Client client = Connect(address)) Until<Snapshot>(client, snapshot => true);
        Check.Throws<OperationError>(() => Connect(without), "it wants its token: give the address that softfinger prints");
        Check.Throws<OperationError>(() => Connect(address + "x"), "another token is wanted");
    }

    /// <summary>What the program would refuse is refused here, and the connection lives on.</summary>
    static void Refuse(string address)
    {
        foreach (string wrong in new[] { "", "ftp://127.0.0.1", "http://", "127.0.0.1:99999", "http://127.0.0.1/other", "http://127.0.0.1/?name=value", "http://a:b@127.0.0.1" })
        {
            Check.Throws<InputError>(() => Connect(wrong), "is no address: it has to be as softfinger prints it");
        }
        Check.Throws<OperationError>(() => Connect("127.0.0.1:1"), "nobody answers");
        using (Client client = Connect(address))
        {
            foreach (Pose wrong in new[] { new Pose(1.1, 0, 0), new Pose(0, double.NaN, 0), new Pose(0, 0, 0, 1.1), new Pose(0, 0, 0, 0), new Pose(0, 0, 0, 1, double.NaN) })
            {
                Check.Throws<InputError>(() => client.SendPoseAsync(0, wrong), "within 1 m, its quaternion of length 1");
            }
            Check.Throws<InputError>(() => client.SendPoseAsync(1, Pose.Identity), "no finger 1: the scene has 1");
            Check.Throws<InputError>(() => client.SendPoseAsync(-1, Pose.Identity), "no finger");
            var hand = new Hand { Tracked = true };
            Check.Throws<InputError>(() => client.SendHandAsync(hand), "joint 0 has to be within 10 m");
            for (int i = 0; i < Hand.JointCount; ++i) hand.Joints[i].Pose = Pose.Identity;
            hand.Joints[24].Radius_m = 0.2f;
            Check.Throws<InputError>(() => client.SendHandAsync(hand), "the radius of joint 24");
            hand.Time_s = -1;
            Check.Throws<InputError>(() => client.SendHandAsync(hand), "its time");
            // As they may be: at the border.
            Wait(client.SendPoseAsync(0, new Pose(1, -1, 1e-9, 0.995)));
            Wait(client.SendPoseAsync(0, new Pose(0, 0, 0.02, 0.995)));
            Until<Snapshot>(client, snapshot => snapshot.Fingers[0].X_WFt.Z_m < 0.0201);
        }
    }

    /// <summary>A server that answers otherwise: the line that says so.</summary>
    /// <summary>The device presses by itself, until that is cancelled; then the scene begins anew, and it stays retracted.</summary>
    static void Learns(string address)
    {
        using (Client client = Connect(address))
        {
            Check.That(client.Scene.Fingers[0].Fittable, "fittable");
            Check.Throws<InputError>(() => client.FitAsync(1), "no finger 1");
            Wait(client.FitAsync(0));
            Fit fit = Until<Fit>(client, told => told.State == "pressing");
            Check.That(fit.Finger == 0 && fit.Of > 1 && fit.Words.Length > 0 && fit.Text == "", "what it does is told");
            Wait(client.CancelFitAsync());
            Fit ended = Until<Fit>(client, told => told.State == "refused");
            Check.That(ended.Text.Contains("ended before it was done"), ended.Text);
            Check.That(Until<Snapshot>(client, told => told.Stopped).Stopped, "retracted");
        }
    }

    static void Answer(string address, string says)
    {
        Check.Throws<OperationError>(() =>
        {
            using (Client client = Connect(address))
            {
                while (Wait(client.ReceiveAsync()) != null) { }
                throw new OperationError("ended");
            }
        }, says);
    }

    /// <summary>The program's own messages cut short, lengthened and spoilt: read, or refused in one line, and nothing else.</summary>
    static void Spoil(string address)
    {
        byte[] bytes;
        string text;
        Receive(address, out text, out bytes);
        var scene = new Scene(Json.Parse(text, "a message"));
        Check.That(SnapshotReader.Read(bytes, bytes.Length, scene) != null, "as it is");
        for (int size = 0; size < bytes.Length; ++size) Check.Throws<OperationError>(() => SnapshotReader.Read(bytes, size, scene), "a snapshot: ");
        var longer = new byte[bytes.Length + 4];
        bytes.CopyTo(longer, 0);
        Check.Throws<OperationError>(() => SnapshotReader.Read(longer, longer.Length, scene), "4 bytes too long");
        var random = new Random(1);
        int refused = 0;
        for (int i = 0; i < 3000; ++i)
        {
            var spoilt = (byte[])bytes.Clone();
            // Counts lie before the skin, and matter most.
            spoilt[random.Next(i % 2 == 0 ? 280 : spoilt.Length)] = (byte)random.Next(256);
            refused += IsRefused(() => SnapshotReader.Read(spoilt, spoilt.Length, scene));
        }
        Check.That(refused > 100, $"{refused} spoilt snapshots refused");
        refused = 0;
        const string Marks = "{}[]\":,0-e\\\u0000";
        for (int i = 0; i < 1000; ++i)
        {
            var spoilt = text.ToCharArray();
            int at = random.Next(spoilt.Length);
            if (i % 2 == 0) spoilt[at] = Marks[random.Next(Marks.Length)];
            string read = new string(spoilt, 0, i % 4 == 1 ? at : spoilt.Length);
            refused += IsRefused(() => new Scene(Json.Parse(read, "a message")));
        }
        Check.That(refused > 300, $"{refused} spoilt scenes refused");
        string nested = new string('[', 100000);
        Check.Throws<OperationError>(() => Json.Parse(nested, "a message"), "at most 64 lists in each other");
        foreach (string number in new[] { "01", "-", "1.", ".5", "1e", "+1", "0x1", "1e999", "NaN", "Infinity", "1,5" })
        {
            Check.Throws<OperationError>(() => Json.Parse(number, "a message"), "a message: not JSON: at character");
        }
        Check.Equal(Json.Parse("-0.5e+01", "a message").Number(), -5.0, "a number");
        Check.Equal(Json.Parse(Json.Quote("a\"\\\n\u00e9"), "a message").Text(), "a\"\\\n\u00e9", "a text");
    }

    /// <summary>The first scene and snapshot as they come.</summary>
    static void Receive(string address, out string text, out byte[] bytes)
    {
        var place = new Address(address);
        using (var socket = new ClientWebSocket())
        {
            socket.Options.Cookies = Wait(place.CookieAsync());
            Wait(socket.ConnectAsync(place.WebSocket, CancellationToken.None));
            var buffer = new byte[1 << 20];
            for (text = null, bytes = null; bytes == null;)
            {
                WebSocketReceiveResult part = Wait(socket.ReceiveAsync(new ArraySegment<byte>(buffer), CancellationToken.None));
                Check.That(part.EndOfMessage, "one message");
                if (text == null) text = System.Text.Encoding.UTF8.GetString(buffer, 0, part.Count);
                else if (part.MessageType == WebSocketMessageType.Binary) Array.Resize(ref buffer, part.Count);
                if (buffer.Length == part.Count) bytes = buffer;
            }
        }
    }

    static int IsRefused(Action read)
    {
        try
        {
            read();
            return 0;
        }
        catch (OperationError)
        {
            return 1;
        }
    }
}
