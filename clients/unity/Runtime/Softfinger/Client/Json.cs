using System;
using System.Collections.Generic;
using System.Globalization;
using System.Text;

namespace Softfinger
{
    /// <summary>A JSON text that came from outside, read strictly (RFC 8259). What is missing or of another kind is told by name.</summary>
    internal sealed class Json
    {
        const int DeepestNesting = 64;

        readonly object value;  // Dictionary<string, Json>, List<Json>, string, double, bool or null
        readonly string name;

        Json(object value, string name)
        {
            this.value = value;
            this.name = name;
        }

        /// <summary>name: what it is, for errors.</summary>
        public static Json Parse(string text, string name)
        {
            var reader = new Reader(text, name);
            Json json = reader.Value(name, 0);
            reader.End();
            return json;
        }

        public bool Has(string key) => Object().ContainsKey(key);

        public Json this[string key]
        {
            get
            {
                Json member;
                if (!Object().TryGetValue(key, out member)) throw new OperationError($"{name}: {key} is missing");
                return member;
            }
        }

        public bool IsNull => value == null;
        public string Text() => value as string ?? throw Wanted("a text");
        public bool Bool() => value is bool ? (bool)value : throw Wanted("true or false");
        public double Number() => value is double ? (double)value : throw Wanted("a number");
        public List<Json> List() => value as List<Json> ?? throw Wanted("a list");

        /// <summary>A whole number from 0 to most.</summary>
        public long Count(long most = 1L << 53)
        {
            double number = Number();
            if (!(number >= 0 && number <= most) || number != Math.Floor(number)) throw Wanted($"a whole number from 0 to {most}");
            return (long)number;
        }

        public T[] Array<T>(Func<Json, T> read)
        {
            List<Json> list = List();
            var array = new T[list.Count];
            for (int i = 0; i < array.Length; ++i) array[i] = read(list[i]);
            return array;
        }

        public OperationError Wanted(string what) => new OperationError($"{name}: {what} is wanted");

        Dictionary<string, Json> Object() => value as Dictionary<string, Json> ?? throw Wanted("an object");

        sealed class Reader
        {
            readonly string text;
            readonly string whole;
            int at;

            public Reader(string text, string whole)
            {
                this.text = text;
                this.whole = whole;
            }

            public void End()
            {
                Space();
                if (at < text.Length) throw Wrong("nothing more");
            }

            public Json Value(string name, int depth)
            {
                if (depth > DeepestNesting) throw Wrong($"at most {DeepestNesting} lists in each other");
                Space();
                switch (Peek())
                {
                    case '{': return new Json(Members(name, depth), name);
                    case '[': return new Json(Items(name, depth), name);
                    case '"': return new Json(Quoted(), name);
                    case 't': return Word("true", true, name);
                    case 'f': return Word("false", false, name);
                    case 'n': return Word("null", null, name);
                    default: return new Json(Number(), name);
                }
            }

            Dictionary<string, Json> Members(string name, int depth)
            {
                var members = new Dictionary<string, Json>();
                ++at;
                Space();
                if (Peek() == '}')
                {
                    ++at;
                    return members;
                }
                while (true)
                {
                    Space();
                    string key = Quoted();
                    Space();
                    Take(':');
                    if (members.ContainsKey(key)) throw Wrong($"{key} but once");
                    members.Add(key, Value($"{whole}: {key}", depth + 1));
                    Space();
                    if (Peek() == ',') ++at;
                    else break;
                }
                Take('}');
                return members;
            }

            List<Json> Items(string name, int depth)
            {
                var items = new List<Json>();
                ++at;
                Space();
                if (Peek() == ']')
                {
                    ++at;
                    return items;
                }
                while (true)
                {
                    items.Add(Value(name, depth + 1));
                    Space();
                    if (Peek() == ',') ++at;
                    else break;
                }
                Take(']');
                return items;
            }

            string Quoted()
            {
                Take('"');
                var result = new StringBuilder();
                while (true)
                {
                    char c = Next();
                    if (c == '"') return result.ToString();
                    if (c < ' ') throw Wrong("no control character in a text");
                    result.Append(c == '\\' ? Escaped() : c);
                }
            }

            char Escaped()
            {
                switch (Next())
                {
                    case '"': return '"';
                    case '\\': return '\\';
                    case '/': return '/';
                    case 'b': return '\b';
                    case 'f': return '\f';
                    case 'n': return '\n';
                    case 'r': return '\r';
                    case 't': return '\t';
                    case 'u': break;
                    default: throw Wrong("an escape of JSON");
                }
                int code = 0;
                for (int i = 0; i < 4; ++i)
                {
                    char c = Next();
                    int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
                    if (digit < 0) throw Wrong("four hexadecimal digits");
                    code = code * 16 + digit;
                }
                return (char)code;
            }

            double Number()
            {
                int begin = at;
                if (Peek() == '-') ++at;
                bool zero = Peek() == '0';
                int digits = Digits();
                bool sound = digits > 0 && (!zero || digits == 1);
                if (Peek() == '.')
                {
                    ++at;
                    sound = Digits() > 0 && sound;
                }
                if (Peek() == 'e' || Peek() == 'E')
                {
                    ++at;
                    if (Peek() == '+' || Peek() == '-') ++at;
                    sound = Digits() > 0 && sound;
                }
                double number = 0;
                sound = sound && double.TryParse(text.Substring(begin, at - begin), NumberStyles.Float, CultureInfo.InvariantCulture, out number);
                if (!sound || double.IsInfinity(number)) throw Wrong("a value");
                return number;
            }

            int Digits()
            {
                int begin = at;
                while (at < text.Length && text[at] >= '0' && text[at] <= '9') ++at;
                return at - begin;
            }

            Json Word(string word, object value, string name)
            {
                if (string.CompareOrdinal(text, at, word, 0, word.Length) != 0) throw Wrong("a value");
                at += word.Length;
                return new Json(value, name);
            }

            void Space()
            {
                while (at < text.Length && (text[at] == ' ' || text[at] == '\n' || text[at] == '\r' || text[at] == '\t')) ++at;
            }

            char Peek() => at < text.Length ? text[at] : '\0';

            char Next()
            {
                if (at >= text.Length) throw Wrong("more");
                return text[at++];
            }

            void Take(char c)
            {
                if (Peek() != c) throw Wrong($"'{c}'");
                ++at;
            }

            OperationError Wrong(string wanted) => new OperationError($"{whole}: not JSON: at character {at + 1}, {wanted} is wanted");
        }

        /// <summary>A text with its quotation marks.</summary>
        public static string Quote(string text)
        {
            var result = new StringBuilder("\"");
            foreach (char c in text)
            {
                if (c == '"' || c == '\\') result.Append('\\').Append(c);
                else if (c < ' ') result.AppendFormat(CultureInfo.InvariantCulture, "\\u{0:x4}", (int)c);
                else result.Append(c);
            }
            return result.Append('"').ToString();
        }

        /// <summary>A number as any reader has it back to the bit.</summary>
        public static string Write(double number) => number.ToString("R", CultureInfo.InvariantCulture);
    }
}
