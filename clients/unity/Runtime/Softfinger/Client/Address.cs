using System;
using System.IO;
using System.Net;
using System.Threading.Tasks;

namespace Softfinger
{
    /// <summary>Where a softfinger runs, as it prints it: http://127.0.0.1:8080, https://HOST:PORT/?token=TOKEN, or HOST:PORT.</summary>
    internal sealed class Address
    {
        const int AnswerTimeout_ms = 10000;
        const string TokenBegins = "?token=";

        public Uri WebSocket { get; }

        readonly Uri page;
        readonly bool hasToken;

        /// <summary>Throws InputError.</summary>
        public Address(string address)
        {
            string text = (address ?? "").Trim();
            if (text.IndexOf("://", StringComparison.Ordinal) < 0) text = "http://" + text;
            Uri uri;
            if (!Uri.TryCreate(text, UriKind.Absolute, out uri) || uri.Host.Length == 0 || uri.UserInfo.Length > 0) throw NoAddress(address);
            bool secure = uri.Scheme == "https" || uri.Scheme == "wss";
            if (!secure && uri.Scheme != "http" && uri.Scheme != "ws") throw NoAddress(address);
            if (uri.AbsolutePath != "/" && uri.AbsolutePath != "/ws") throw NoAddress(address);
            hasToken = uri.Query.StartsWith(TokenBegins, StringComparison.Ordinal) && uri.Query.Length > TokenBegins.Length;
            if (!hasToken && uri.Query.Length > 0) throw NoAddress(address);
            // An IPv6 address keeps its brackets.
            string host = uri.GetComponents(UriComponents.Host, UriFormat.UriEscaped);
            page = new Uri($"{(secure ? "https" : "http")}://{host}:{uri.Port}/{uri.Query}");
            WebSocket = new Uri($"{(secure ? "wss" : "ws")}://{host}:{uri.Port}/ws");
        }

        /// <summary>With the token where there is one the server hands out a cookie, which opens all else; null: without.</summary>
        public async Task<CookieContainer> CookieAsync()
        {
            if (!hasToken) return null;
            var request = (HttpWebRequest)WebRequest.Create(page);
            request.AllowAutoRedirect = false;
            request.Timeout = AnswerTimeout_ms;
            string given;
            try
            {
                using (var answer = (HttpWebResponse)await request.GetResponseAsync().ConfigureAwait(false))
                {
                    given = answer.Headers["Set-Cookie"];
                }
            }
            catch (WebException failure)
            {
                var answer = failure.Response as HttpWebResponse;
                if (answer == null) throw Nobody();
                throw new OperationError(answer.StatusCode == HttpStatusCode.Unauthorized
                    ? $"{Where}: another token is wanted: give the address that softfinger prints"
                    : $"{Where}: refused ({(int)answer.StatusCode}): give the address that softfinger prints");
            }
            return Cookies(given);
        }

        CookieContainer Cookies(string given)
        {
            string pair = (given ?? "").Split(';')[0];
            int equals = pair.IndexOf('=');
            // A program without --token hands out none, and wants none.
            if (equals <= 0) return null;
            var cookies = new CookieContainer();
            try
            {
                cookies.Add(WebSocket, new Cookie(pair.Substring(0, equals), pair.Substring(equals + 1), "/"));
            }
            catch (CookieException)
            {
                throw new OperationError($"{Where}: its cookie is none");
            }
            return cookies;
        }

        public OperationError Nobody() => new OperationError($"{Where}: nobody answers: is softfinger running, and its page there?");

        public OperationError NoWebSocket() => new OperationError(
            $"{Where}: no page of softfinger, or it wants its token: give the address that softfinger prints");

        /// <summary>For errors; tells no token.</summary>
        public string Where => page.GetComponents(UriComponents.SchemeAndServer, UriFormat.UriEscaped);

        static InputError NoAddress(string address) => new InputError(
            $"\"{address}\" is no address: it has to be as softfinger prints it, e.g. http://127.0.0.1:8080");
    }
}
