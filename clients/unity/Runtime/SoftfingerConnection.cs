using System;
using System.Collections.Generic;
using System.Threading;
using System.Threading.Tasks;
using UnityEngine;

namespace Softfinger.Unity
{
    /// <summary>
    /// A running softfinger. The scene lies where this object lies, its world's origin here, z up along y. Events come in Update, before
    /// that of other components; where frames are rarer than snapshots, the newest counts.
    /// </summary>
    [DefaultExecutionOrder(-100)]
    [AddComponentMenu("softfinger/Connection")]
    public sealed class SoftfingerConnection : MonoBehaviour
    {
        const int MostLines = 100, MostEvents = 256;

        [SerializeField, Tooltip("As softfinger prints it, with its token")]
        string address = "http://127.0.0.1:8080";

        [SerializeField, Tooltip("s, between attempts to connect")]
        float retry_s = 1;

        static readonly ObjectEvents.Event[] Nothing = new ObjectEvents.Event[0];
        readonly object gate = new object();
        readonly Queue<string> lines = new Queue<string>();
        readonly Queue<ObjectEvents.Event> events = new Queue<ObjectEvents.Event>();
        Scene nextScene;
        Snapshot nextSnapshot;
        long generation;
        Client client;
        CancellationTokenSource end;
        string lastFailure;
        Task sending = Task.CompletedTask;

        /// <summary>Counts when it is enabled the next time.</summary>
        public string Address
        {
            get => address;
            set => address = value;
        }

        /// <summary>Null before the first.</summary>
        public Scene Scene { get; private set; }

        /// <summary>The newest, of Scene; null before the first.</summary>
        public Snapshot Snapshot { get; private set; }

        public event Action<Scene> SceneBegan;
        public event Action<Snapshot> SnapshotCame;

        /// <summary>What happened to an object that moves by forces, each once; where a frame takes long, the newest 256.</summary>
        public event Action<ObjectEvents.Event> Happened;

        /// <summary>A line that people should read: what softfinger says, or what is wrong with the connection.</summary>
        public event Action<string> Said;

        public bool IsConnected
        {
            get
            {
                lock (gate) return client != null;
            }
        }

        /// <summary>Retracts every device at once, and until it is released.</summary>
        public void Stop() => Send(to => to.StopAsync());

        /// <summary>Releases devices from the stops that the newest snapshot tells of.</summary>
        public void Release()
        {
            Snapshot newest = Snapshot;
            if (newest != null) Send(to => to.ReleaseAsync(newest));
        }

        public void Pause() => Send(to => to.PauseAsync());
        public void Resume() => Send(to => to.ResumeAsync());
        public void Restart() => Send(to => to.RestartAsync());

        /// <summary>One of Scene.Scenes.</summary>
        public void ChooseScene(string scene) => Send(to => to.ChooseSceneAsync(scene));

        /// <summary>To be sent again in every frame: dropped while the one before has not gone.</summary>
        internal void SendPose(int finger, Pose X_WFt) => SendNewest(to => to.SendPoseAsync(finger, X_WFt));

        internal void SendHand(Hand hand) => SendNewest(to => to.SendHandAsync(hand));

        /// <summary>Place of a finger in the scene, by its name; the first where that is empty; -1: there is none.</summary>
        public int FingerNamed(string finger)
        {
            if (Scene == null) return -1;
            for (int i = 0; i < Scene.Fingers.Count; ++i)
            {
                if (string.IsNullOrEmpty(finger) || Scene.Fingers[i].Name == finger) return i;
            }
            return -1;
        }

        void SendNewest(Func<Client, Task> send)
        {
            if (sending.IsCompleted) sending = Send(send);
        }

        Task Send(Func<Client, Task> send)
        {
            Client to;
            lock (gate) to = client;
            return to == null ? Task.CompletedTask : SendTo(to, send);
        }

        async Task SendTo(Client to, Func<Client, Task> send)
        {
            try
            {
                await send(to).ConfigureAwait(false);
            }
            catch (Exception failure) when (failure is InputError || failure is OperationError)
            {
                Fail(failure.Message);
            }
        }

        void OnEnable()
        {
            end = new CancellationTokenSource();
            CancellationToken until = end.Token;
            string to = address;
            TimeSpan pause = TimeSpan.FromSeconds(Math.Max(0.1f, retry_s));
            Task.Run(() => Listen(to, pause, until));
        }

        void OnDisable()
        {
            end.Cancel();
            lock (gate) client = null;
        }

        async Task Listen(string to, TimeSpan pause, CancellationToken until)
        {
            while (!until.IsCancellationRequested)
            {
                try
                {
                    await Follow(to, until).ConfigureAwait(false);
                    Fail(to + ": the connection has ended");
                }
                catch (Exception failure) when (failure is InputError || failure is OperationError)
                {
                    Fail(failure.Message);
                }
                catch (OperationCanceledException)
                {
                    return;
                }
                await Task.Delay(pause).ConfigureAwait(false);
            }
        }

        async Task Follow(string to, CancellationToken until)
        {
            using (Client connected = await Client.ConnectAsync(to, until).ConfigureAwait(false))
            {
                lock (gate)
                {
                    if (until.IsCancellationRequested) return;
                    client = connected;
                    Begin(connected.Scene);
                    lastFailure = null;
                }
                try
                {
                    for (Message message; (message = await connected.ReceiveAsync(until).ConfigureAwait(false)) != null;) Take(message);
                }
                finally
                {
                    lock (gate)
                    {
                        if (client == connected) client = null;
                    }
                }
            }
        }

        /// <summary>What belongs to the scene before is over.</summary>
        void Begin(Scene scene)
        {
            nextScene = scene;
            generation = scene.Generation;
            nextSnapshot = null;
            events.Clear();
        }

        void Take(Message message)
        {
            lock (gate)
            {
                if (message is Scene scene) Begin(scene);
                else if (message is Snapshot snapshot) nextSnapshot = snapshot;
                else if (message is ObjectEvents happened && happened.Generation == generation)
                {
                    foreach (ObjectEvents.Event one in happened.Events) events.Enqueue(one);
                    while (events.Count > MostEvents) events.Dequeue();
                }
                else if (message is Notifications told)
                {
                    foreach (string line in told.Lines) Say(line);
                }
            }
        }

        /// <summary>The same failure again and again is told once.</summary>
        void Fail(string line)
        {
            lock (gate)
            {
                if (line == lastFailure) return;
                lastFailure = line;
                Say(line);
            }
        }

        void Say(string line)
        {
            lines.Enqueue(line);
            while (lines.Count > MostLines) lines.Dequeue();
        }

        void Update()
        {
            Scene scene;
            Snapshot snapshot;
            ObjectEvents.Event[] happened;
            lock (gate)
            {
                scene = nextScene;
                snapshot = nextSnapshot;
                happened = events.Count > 0 ? events.ToArray() : Nothing;
                nextScene = null;
                nextSnapshot = null;
                events.Clear();
            }
            if (scene != null)
            {
                Scene = scene;
                Snapshot = null;
                SceneBegan?.Invoke(scene);
            }
            foreach (ObjectEvents.Event one in happened) Happened?.Invoke(one);
            if (snapshot != null)
            {
                Snapshot = snapshot;
                SnapshotCame?.Invoke(snapshot);
            }
            for (string line; (line = NextLine()) != null;)
            {
                if (Said != null) Said.Invoke(line);
                else Debug.Log("softfinger: " + line);
            }
        }

        string NextLine()
        {
            lock (gate) return lines.Count > 0 ? lines.Dequeue() : null;
        }
    }
}
