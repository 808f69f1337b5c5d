using System;
using UnityEngine;
using UnityEngine.Events;

namespace Softfinger.Unity
{
    /// <summary>N s; 0 where none is told.</summary>
    [Serializable]
    public sealed class ImpulseEvent : UnityEvent<float> { }

    /// <summary>What happens to an object that moves by forces, as events for the inspector: for a sound, a flash, the rules of a game.</summary>
    [AddComponentMenu("softfinger/Object Events")]
    public sealed class EventsOfObject : ConnectedBehaviour
    {
        [SerializeField, Tooltip("Of the scene; empty: all of them")]
        string objectName = "";

        [SerializeField, Tooltip("Of what meets it, an object or a finger; empty: whatever it is")]
        string other = "";

        [SerializeField, Tooltip("Two that did not touch begin to; N s")]
        ImpulseEvent impact = new ImpulseEvent();

        [SerializeField, Tooltip("They do not touch any more")]
        UnityEvent release = new UnityEvent();

        [SerializeField, Tooltip("A button snaps in or out; N s")]
        ImpulseEvent click = new ImpulseEvent();

        [SerializeField, Tooltip("A knob comes to its next rest")]
        UnityEvent detent = new UnityEvent();

        [SerializeField, Tooltip("A joint meets its end; N s")]
        ImpulseEvent limit = new ImpulseEvent();

        public string ObjectName
        {
            get => objectName;
            set => objectName = value;
        }

        public string Other
        {
            get => other;
            set => other = value;
        }

        public ImpulseEvent Impact => impact;
        public UnityEvent Release => release;
        public ImpulseEvent Click => click;
        public UnityEvent Detent => detent;
        public ImpulseEvent Limit => limit;

        protected override void OnEvent(ObjectEvents.Event happened)
        {
            if (!Concerns(happened.Object, happened.Other) && !Concerns(happened.Other, happened.Object)) return;
            float impulse_N_s = double.IsNaN(happened.Impulse_N_s) ? 0 : (float)happened.Impulse_N_s;
            switch (happened.Kind)
            {
                case "impact":
                    impact.Invoke(impulse_N_s);
                    break;
                case "release":
                    release.Invoke();
                    break;
                case "click":
                    click.Invoke(impulse_N_s);
                    break;
                case "detent":
                    detent.Invoke();
                    break;
                case "limit":
                    limit.Invoke(impulse_N_s);
                    break;
            }
        }

        bool Concerns(string one, string met) =>
            one != null && (objectName.Length == 0 || one == objectName) && (other.Length == 0 || met == other);
    }
}
