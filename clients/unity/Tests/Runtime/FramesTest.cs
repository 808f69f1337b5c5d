using NUnit.Framework;
using UnityEngine;

namespace Softfinger.Unity.Tests
{
    public sealed class FramesTest
    {
        [Test]
        public void TheTipIsForwardTheNailUpAndLeftIsLeft()
        {
            Assert.AreEqual(new Vector3(0, 0, 1), Frames.ToUnity(1, 0, 0));
            Assert.AreEqual(new Vector3(-1, 0, 0), Frames.ToUnity(0, 1, 0));
            Assert.AreEqual(new Vector3(0, 1, 0), Frames.ToUnity(0, 0, 1));
        }

        [Test]
        public void ATurnTurnsWhatItTurnsThere()
        {
            // A quarter about z of W: what was ahead is to the left.
            float half = Mathf.Sqrt(0.5f);
            var pose = new Pose(0, 0, 0, half, 0, 0, half);
            Vector3 turned = Frames.RotationToUnity(pose) * Vector3.forward;
            Assert.AreEqual(-1, turned.x, 1e-6);
            Assert.AreEqual(0, turned.z, 1e-6);
        }

        [Test]
        public void ThereAndBack()
        {
            var pose = new Pose(0.25, -0.5, 0.125, 0.5, 0.5, -0.5, 0.5);
            Pose back = Frames.FromUnity(Frames.PositionToUnity(pose), Frames.RotationToUnity(pose));
            Assert.AreEqual(pose, back);
        }
    }
}
