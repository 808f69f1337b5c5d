using System;
using System.Collections.Generic;
using System.IO;
using System.Net;
using System.Net.Sockets;
using System.Net.WebSockets;
using System.Text;
using System.Threading;
using System.Threading.Tasks;

namespace Softfinger
{
    /// <summary>
    /// A running softfinger (`softfinger run`), by the WebSocket of its live page.
    ///
    ///     using (Client client = await Client.ConnectAsync("http://127.0.0.1:8080"))
    ///     {
    ///         while (await client.ReceiveAsync() is Message message)
    ///         {
    ///             if (message is Snapshot snapshot) Console.WriteLine(snapshot.Fingers[0].NormalForce_N);
    ///         }
    ///     }
    ///
    /// One ReceiveAsync at a time; sending is any thread's. What is asked for shows in the snapshots that follow.
    /// </summary>
    public sealed class Client : IDisposable
    {
        /// <summary>The version of the protocol that this client speaks.</summary>
        public const int Protocol = 2;

        const int MostBytes = 64 << 20;
        const int MostRequestBytes = 1024;
        const double Farthest_m = 1;
        static readonly TimeSpan ConnectTimeout = TimeSpan.FromSeconds(10);
        static readonly UTF8Encoding Strict = new UTF8Encoding(false, true);

        readonly Address address;
        readonly ClientWebSocket socket = new ClientWebSocket();
        readonly SemaphoreSlim sending = new SemaphoreSlim(1);
        byte[] buffer = new byte[16384];

        /// <summary>The scene that runs; the newest that ReceiveAsync has given.</summary>
        public Scene Scene { get; private set; }

        Client(Address address) => this.address = address;

        /// <summary>
        /// Connects and waits for the scene, 10 s at most. address: as softfinger prints it, with its token where there is
        /// one. Throws InputError for what is no address, OperationError where nobody answers or answers otherwise.
        /// </summary>
        public static async Task<Client> ConnectAsync(string address, CancellationToken cancel = default(CancellationToken))
        {
            var client = new Client(new Address(address));
            try
            {
                using (var patience = CancellationTokenSource.CreateLinkedTokenSource(cancel))
                {
                    patience.CancelAfter(ConnectTimeout);
                    await client.Open(patience.Token).ConfigureAwait(false);
                }
                return client;
            }
            catch (OperationCanceledException) when (!cancel.IsCancellationRequested)
            {
                client.Dispose();
                throw client.address.Nobody();
            }
            catch
            {
                client.Dispose();
                throw;
            }
        }

        async Task Open(CancellationToken cancel)
        {
            CookieContainer cookies = await address.CookieAsync().ConfigureAwait(false);
            if (cookies != null) socket.Options.Cookies = cookies;
            try
            {
                await socket.ConnectAsync(address.WebSocket, cancel).ConfigureAwait(false);
            }
            catch (Exception failure) when (failure is WebSocketException || failure is SocketException || failure is IOException)
            {
                cancel.ThrowIfCancellationRequested();
                throw IsUnreachable(failure) ? address.Nobody() : address.NoWebSocket();
            }
            while (Scene == null)
            {
                if (await ReceiveAsync(cancel).ConfigureAwait(false) == null) throw address.Nobody();
            }
        }

        static bool IsUnreachable(Exception failure)
        {
            for (; failure != null; failure = failure.InnerException)
            {
                if (failure is SocketException) return true;
            }
            return false;
        }

        /// <summary>
        /// The next message; null: the program has ended, or the way to it. Snapshots come up to 60 times a second, and only
        /// the newest to who is slow. Throws OperationError for what is no message of this protocol, or a refusal. Cancelling ends
        /// the connection.
        /// </summary>
        public async Task<Message> ReceiveAsync(CancellationToken cancel = default(CancellationToken))
        {
            while (true)
            {
                int size = 0;
                WebSocketReceiveResult part;
                do
                {
                    if (size == buffer.Length) Grow();
                    try
                    {
                        part = await socket.ReceiveAsync(new ArraySegment<byte>(buffer, size, buffer.Length - size), cancel).ConfigureAwait(false);
                    }
                    catch (Exception failure) when (IsEnd(failure, cancel))
                    {
                        return null;
                    }
                    if (part.MessageType == WebSocketMessageType.Close) return Closed();
                    size += part.Count;
                }
                while (!part.EndOfMessage);
                Message message = part.MessageType == WebSocketMessageType.Text
                    ? ReadText(size)
                    : SnapshotReader.Read(buffer, size, SceneOfSnapshot());
                if (message != null) return message;
            }
        }

        bool IsEnd(Exception failure, CancellationToken cancel)
        {
            if (cancel.IsCancellationRequested) return false;
            return failure is WebSocketException || failure is IOException || failure is SocketException || failure is ObjectDisposedException ||
                failure is OperationCanceledException;
        }

        void Grow()
        {
            if (buffer.Length >= MostBytes) throw Wrong($"a message of more than {MostBytes >> 20} MiB");
            Array.Resize(ref buffer, 2 * buffer.Length);
        }

        Scene SceneOfSnapshot() => Scene ?? throw Wrong("a snapshot before any scene");

        /// <summary>Null: of a kind that a later version may have.</summary>
        Message ReadText(int size)
        {
            string text;
            try
            {
                text = Strict.GetString(buffer, 0, size);
            }
            catch (DecoderFallbackException)
            {
                throw Wrong("a text that is not UTF-8");
            }
            Json json = Json.Parse(text, "a message");
            switch (json["type"].Text())
            {
                case "scene": return Scene = new Scene(json);
                case "loading": return new Loading(json);
                case "registration": return new Registration(json);
                case "fit": return new Fit(json);
                case "notifications": return new Notifications(json);
                case "events": return new ObjectEvents(json);
                default: return null;
            }
        }

        Message Closed()
        {
            if (socket.CloseStatus != WebSocketCloseStatus.PolicyViolation) return null;
            throw new OperationError($"{address.Where}: refused what this client sent: {socket.CloseStatusDescription}");
        }

        OperationError Wrong(string what) => new OperationError($"{address.Where}: {what}");

        /// <summary>
        /// Where a finger is wanted whose tracker is page: X_WFt, within 1 m. To be sent again and again, moved or not: after 200 ms
        /// without any its tracking is lost. Of several who send poses or hands, the first moves fingers while it is connected.
        /// </summary>
        public Task SendPoseAsync(int finger, Pose X_WFt)
        {
            return RequestAsync("pose", $",\"finger\":{Finger(finger)}{Written(X_WFt)}");
        }

        /// <summary>
        /// A person holds an object, one that is Holdable, at X_WO, within 1 m: a spring pulls it there, as hard as a hand would. To
        /// be sent again and again: after 200 ms without any it is let go.
        /// </summary>
        public Task HoldAsync(string name, Pose X_WO) => RequestAsync("hold", $",\"object\":{HoldableObject(name)}{Written(X_WO)}");

        /// <summary>It flies on as it moved.</summary>
        public Task LetGoAsync(string name) => RequestAsync("let_go", $",\"object\":{HoldableObject(name)}");

        /// <summary>A hand, for fingers whose tracker is webxr. After 200 ms without any the fingers' tracking is lost.</summary>
        public Task SendHandAsync(Hand hand) => SendAsync(hand.ToBytes(), WebSocketMessageType.Binary);

        /// <summary>Retracts every device at once, and until it is released.</summary>
        public Task StopAsync() => RequestAsync("stop");

        /// <summary>Releases devices from the stops that this snapshot, the newest, tells of; not from any that came since.</summary>
        public Task ReleaseAsync(Snapshot newest) => RequestAsync("release", $",\"generation\":{newest.Generation},\"stops\":{newest.Stops}");

        /// <summary>One of Scene.Scenes.</summary>
        public Task ChooseSceneAsync(string scene)
        {
            foreach (string name in Scene.Scenes)
            {
                if (name == scene) return RequestAsync("scene", $",\"scene\":{Json.Quote(scene)}");
            }
            throw new InputError($"no scene {scene}: there is {string.Join(", ", Scene.Scenes)}");
        }

        /// <summary>What a finger's device shall be led by: the name of one of Scene.Objectives.</summary>
        public Task ChooseObjectiveAsync(int finger, string objective)
        {
            foreach (Named named in Scene.Objectives)
            {
                if (named.Name == objective) return RequestAsync("objective", $",\"finger\":{Finger(finger)},\"objective\":{Json.Quote(objective)}");
            }
            throw new InputError($"no objective {objective}: there is {string.Join(", ", new List<Named>(Scene.Objectives).ConvertAll(named => named.Name))}");
        }

        public Task PauseAsync() => RequestAsync("pause");
        public Task ResumeAsync() => RequestAsync("resume");

        /// <summary>Begins the scene anew.</summary>
        public Task RestartAsync() => RequestAsync("restart");

        /// <summary>Begins the registration of what a finger's tracker follows; how it stands comes as Registration.</summary>
        public Task RegisterAsync(int finger) => RequestAsync("register", $",\"finger\":{Finger(finger)}");

        public Task CancelRegistrationAsync() => RequestAsync("cancel_registration");

        /// <summary>
        /// The device of a Fittable finger retracts, then presses by itself and learns who wears it; how that stands comes as Fit.
        /// again: the finger is known, the device was put on again.
        /// </summary>
        public Task FitAsync(int finger, bool again = false) =>
            RequestAsync("fit", $",\"finger\":{Finger(finger)}{(again ? ",\"again\":true" : "")}");

        /// <summary>The device retracts, and nothing is written.</summary>
        public Task CancelFitAsync() => RequestAsync("cancel_fit");

        /// <summary>The wearer feels the device, of a fit by touches.</summary>
        public Task FeltAsync() => RequestAsync("felt");

        public void Dispose() => socket.Dispose();

        int Finger(int finger)
        {
            if (finger < 0 || finger >= Scene.Fingers.Count) throw new InputError($"no finger {finger}: the scene has {Scene.Fingers.Count}, from 0");
            return finger;
        }

        string HoldableObject(string name)
        {
            foreach (SceneObject of in Scene.Objects)
            {
                if (of.Holdable && of.Name == name) return Json.Quote(name);
            }
            throw new InputError($"no object {name} that can be held: there is {string.Join(", ", new List<SceneObject>(Scene.Objects).FindAll(of => of.Holdable).ConvertAll(of => of.Name))}");
        }

        static string Written(Pose pose)
        {
            if (!pose.IsWithin(Farthest_m)) throw new InputError($"a pose: it has to be within {Farthest_m} m, its quaternion of length 1");
            return $",\"position_mm\":[{Mm(pose.X_m)},{Mm(pose.Y_m)},{Mm(pose.Z_m)}]," +
                $"\"quaternion\":[{Json.Write(pose.Qw)},{Json.Write(pose.Qx)},{Json.Write(pose.Qy)},{Json.Write(pose.Qz)}]";
        }

        static string Mm(double metres) => Json.Write(1e3 * metres);

        Task RequestAsync(string request, string more = "") =>
            SendAsync(Strict.GetBytes($"{{\"request\":\"{request}\"{more}}}"), WebSocketMessageType.Text);

        async Task SendAsync(byte[] message, WebSocketMessageType type)
        {
            if (message.Length > MostRequestBytes) throw new InputError($"a request of {message.Length} bytes: there is room for {MostRequestBytes}");
            await sending.WaitAsync().ConfigureAwait(false);
            try
            {
                await socket.SendAsync(new ArraySegment<byte>(message), type, true, CancellationToken.None).ConfigureAwait(false);
            }
            catch (Exception failure) when (IsEnd(failure, CancellationToken.None) || failure is InvalidOperationException)
            {
                throw Wrong("the connection has ended");
            }
            finally
            {
                sending.Release();
            }
        }
    }
}
