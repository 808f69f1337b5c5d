// Prints time and normal force of each snapshot of a running softfinger, until it ends.
//
//     mono Contact.exe http://127.0.0.1:8080
using System;
using System.Globalization;
using System.Threading.Tasks;
using Softfinger;

static class Contact
{
    static int Main(string[] arguments)
    {
        if (arguments.Length != 1)
        {
            Console.Error.WriteLine("usage: Contact ADDRESS, as softfinger run prints it");
            return 2;
        }
        try
        {
            Print(arguments[0]).GetAwaiter().GetResult();
            return 0;
        }
        catch (InputError error)
        {
            Console.Error.WriteLine("Contact: " + error.Message);
            return 2;
        }
        catch (OperationError error)
        {
            Console.Error.WriteLine("Contact: " + error.Message);
            return 1;
        }
    }

    static async Task Print(string address)
    {
        using (Client client = await Client.ConnectAsync(address))
        {
            while (await client.ReceiveAsync() is Message message)
            {
                var snapshot = message as Snapshot;
                if (snapshot == null) continue;
                Console.Write(string.Format(CultureInfo.InvariantCulture, "{0:F3} s", snapshot.Time_s));
                foreach (FingerSnapshot finger in snapshot.Fingers)
                {
                    Console.Write(string.Format(CultureInfo.InvariantCulture, "  {0:F4} N", finger.NormalForce_N));
                }
                Console.WriteLine();
            }
        }
    }
}
