using UnityEngine;

namespace Softfinger.Unity
{
    /// <summary>What a connection tells of scenes, snapshots and objects: the one named, or the nearest above in the hierarchy.</summary>
    public abstract class ConnectedBehaviour : MonoBehaviour
    {
        [SerializeField, Tooltip("Empty: of a parent")]
        SoftfingerConnection connection = null;

        /// <summary>Null: there is none. To be set before it is enabled.</summary>
        public SoftfingerConnection Connection
        {
            get => connection;
            set => connection = value;
        }

        protected virtual void OnScene(Scene scene) { }
        protected virtual void OnSnapshot(Snapshot snapshot) { }
        protected virtual void OnEvent(ObjectEvents.Event happened) { }

        protected virtual void OnEnable()
        {
            if (connection == null) connection = GetComponentInParent<SoftfingerConnection>();
            if (connection == null)
            {
                Debug.LogError($"softfinger: {GetType().Name} on {name}: no connection: name one, or put it below one");
                enabled = false;
                return;
            }
            connection.SceneBegan += OnScene;
            connection.SnapshotCame += OnSnapshot;
            connection.Happened += OnEvent;
            if (connection.Scene != null) OnScene(connection.Scene);
            if (connection.Snapshot != null) OnSnapshot(connection.Snapshot);
        }

        protected virtual void OnDisable()
        {
            if (connection == null) return;
            connection.SceneBegan -= OnScene;
            connection.SnapshotCame -= OnSnapshot;
            connection.Happened -= OnEvent;
        }
    }
}
