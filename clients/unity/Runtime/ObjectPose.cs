using UnityEngine;

namespace Softfinger.Unity
{
    /// <summary>This object lies in its parent where an object of the scene lies in its world.</summary>
    [AddComponentMenu("softfinger/Object Pose")]
    public sealed class ObjectPose : ConnectedBehaviour
    {
        [SerializeField, Tooltip("Of the scene; empty: its first")]
        string objectName = "";

        public string ObjectName
        {
            get => objectName;
            set => objectName = value;
        }

        protected override void OnSnapshot(Snapshot snapshot)
        {
            for (int i = 0; i < snapshot.X_WO.Count; ++i)
            {
                if (objectName.Length > 0 && Connection.Scene.Objects[i].Name != objectName) continue;
                Frames.Place(transform, snapshot.X_WO[i]);
                return;
            }
        }
    }
}
