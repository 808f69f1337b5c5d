using System;
using UnityEngine;
using UnityEngine.Events;

namespace Softfinger.Unity
{
    /// <summary>N.</summary>
    [Serializable]
    public sealed class ForceEvent : UnityEvent<float> { }

    [Serializable]
    public sealed class StateEvent : UnityEvent<string> { }

    /// <summary>What a finger feels and its device does, as events for the inspector.</summary>
    [AddComponentMenu("softfinger/Contact Events")]
    public sealed class ContactEvents : ConnectedBehaviour
    {
        [SerializeField, Tooltip("Empty: the first of the scene")]
        string finger = "";

        [SerializeField]
        UnityEvent touched = new UnityEvent();

        [SerializeField]
        UnityEvent letGo = new UnityEvent();

        [SerializeField, Tooltip("N, of each snapshot")]
        ForceEvent normalForce = new ForceEvent();

        [SerializeField, Tooltip("ready, rendering, retracting, stopped, ...; where it changes")]
        StateEvent deviceState = new StateEvent();

        bool touches;
        string state = "";

        public string Finger
        {
            get => finger;
            set => finger = value;
        }

        public UnityEvent Touched => touched;
        public UnityEvent LetGo => letGo;
        public ForceEvent NormalForce => normalForce;
        public StateEvent DeviceState => deviceState;

        protected override void OnSnapshot(Snapshot snapshot)
        {
            int index = Connection.FingerNamed(finger);
            if (index < 0) return;
            FingerSnapshot of = snapshot.Fingers[index];
            bool now = of.NormalForceSum_N > 0;
            if (now != touches)
            {
                touches = now;
                (now ? touched : letGo).Invoke();
            }
            normalForce.Invoke(of.NormalForce_N);
            if (of.DeviceState == state) return;
            state = of.DeviceState;
            deviceState.Invoke(state);
        }
    }
}
