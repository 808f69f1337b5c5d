using System;
using System.Globalization;
using System.Threading;

/// <summary>What a test expects. The first that is not so ends the program with status 1; as does a test that expects nothing.</summary>
static class Check
{
    static int expected;

    /// <summary>The status of a program whose test this is.</summary>
    public static int Status(Action test)
    {
        // Numbers on the wire do not depend on the locale.
        Thread.CurrentThread.CurrentCulture = CultureInfo.DefaultThreadCurrentCulture = WithCommas();
        try
        {
            test();
        }
        catch (Exception failure)
        {
            Console.Error.WriteLine(failure);
            return 1;
        }
        if (expected > 0) return 0;
        Console.Error.WriteLine("nothing was expected");
        return 1;
    }

    public static void That(bool condition, string what)
    {
        ++expected;
        if (!condition) throw new Exception("not so: " + what);
    }

    public static void Equal<T>(T found, T wanted, string what)
    {
        ++expected;
        if (!Equals(found, wanted)) throw new Exception($"{what}: {found} instead of {wanted}");
    }

    /// <summary>Throws this exception, of one line that says so.</summary>
    public static void Throws<T>(Action action, string says) where T : Exception
    {
        ++expected;
        try
        {
            action();
        }
        catch (T failure)
        {
            if (failure.Message.Contains(says) && failure.Message.IndexOf('\n') < 0) return;
            throw new Exception($"\"{failure.Message}\" instead of a line with \"{says}\"", failure);
        }
        throw new Exception($"no {typeof(T).Name} with \"{says}\"");
    }

    static CultureInfo WithCommas()
    {
        var culture = (CultureInfo)CultureInfo.InvariantCulture.Clone();
        culture.NumberFormat.NumberDecimalSeparator = ",";
        culture.NumberFormat.NegativeSign = "~";
        return culture;
    }
}
