using System.Collections.Generic;

namespace Softfinger
{
    /// <summary>What a running softfinger sends: a Scene, Snapshot, Loading, Registration, Fit, Notifications or ObjectEvents.</summary>
    public abstract class Message
    {
        internal Message() { }
    }

    /// <summary>Another scene is on its way, or the same one anew.</summary>
    public sealed class Loading : Message
    {
        /// <summary>Empty: none is.</summary>
        public string Scene { get; }

        internal Loading(Json json) => Scene = json["scene"].Text();
    }

    /// <summary>What people are told on the terminal.</summary>
    public sealed class Notifications : Message
    {
        public IReadOnlyList<string> Lines { get; }

        internal Notifications(Json json) => Lines = json["lines"].Array(line => line.Text());
    }

    /// <summary>What happened to objects of a scene that move by forces, each once.</summary>
    public sealed class ObjectEvents : Message
    {
        public struct Event
        {
            /// <summary>Simulated.</summary>
            public double Time_s;

            /// <summary>impact, release, click, detent or limit.</summary>
            public string Kind;

            /// <summary>Its name.</summary>
            public string Object;

            /// <summary>An object's or a finger's; null: none.</summary>
            public string Other;

            /// <summary>NaN: none.</summary>
            public double Impulse_N_s;
        }

        /// <summary>Of the scene; low bits of it are a snapshot's.</summary>
        public long Generation { get; }

        public IReadOnlyList<Event> Events { get; }

        internal ObjectEvents(Json json)
        {
            Generation = json["generation"].Count();
            Events = json["events"].Array(told => new Event
            {
                Time_s = told["time_s"].Number(),
                Kind = told["kind"].Text(),
                Object = told["object"].Text(),
                Other = told["other"].IsNull ? null : told["other"].Text(),
                Impulse_N_s = told["impulse_N_s"].IsNull ? double.NaN : told["impulse_N_s"].Number(),
            });
        }
    }

    /// <summary>How the registration of a tracked finger stands.</summary>
    public sealed class Registration : Message
    {
        /// <summary>idle, running, saved or refused.</summary>
        public string State { get; }

        /// <summary>Which of the scene's.</summary>
        public int Finger { get; }

        /// <summary>Postures that were held, of so many.</summary>
        public int Held { get; }

        public int Of { get; }

        /// <summary>To hold now, and how: one sentence.</summary>
        public string Posture { get; }

        public string Words { get; }

        /// <summary>Of holding it, 0 to 1.</summary>
        public double Progress { get; }

        /// <summary>What was found, or why nothing was saved.</summary>
        public string Text { get; }

        internal Registration(Json json)
        {
            State = json["state"].Text();
            Finger = (int)json["finger"].Count(int.MaxValue);
            Held = (int)json["held"].Count(int.MaxValue);
            Of = (int)json["of"].Count(int.MaxValue);
            Posture = json["posture"].Text();
            Words = json["words"].Text();
            Progress = json["progress"].Number();
            Text = json["message"].Text();
        }
    }

    /// <summary>How a fit of a device to its wearer stands.</summary>
    public sealed class Fit : Message
    {
        /// <summary>idle, waiting (until the device has retracted), pressing, estimating, saved or refused.</summary>
        public string State { get; }

        /// <summary>Which of the scene's.</summary>
        public int Finger { get; }

        /// <summary>Presses are touches that the wearer tells, by FeltAsync.</summary>
        public bool ByTouch { get; }

        /// <summary>Under way, from 1, of so many that are planned; 0: none yet.</summary>
        public int Press { get; }

        public int Of { get; }

        /// <summary>What happens now, one sentence.</summary>
        public string Words { get; }

        /// <summary>As the sensor says.</summary>
        public double Force_N { get; }

        /// <summary>Of the presses, then of the estimate, 0 to 1.</summary>
        public double Progress { get; }

        /// <summary>What was found, or why nothing was saved.</summary>
        public string Text { get; }

        internal Fit(Json json)
        {
            State = json["state"].Text();
            Finger = (int)json["finger"].Count(int.MaxValue);
            ByTouch = json["by_touch"].Bool();
            Press = (int)json["press"].Count(int.MaxValue);
            Of = (int)json["of"].Count(int.MaxValue);
            Words = json["words"].Text();
            Force_N = json["force_N"].Number();
            Progress = json["progress"].Number();
            Text = json["message"].Text();
        }
    }
}
