#!/bin/sh
# Every example against installed packages, from the folder that has examples and clients: in C, C++, Python, C# and
# JavaScript. Run by bare_root_test.py.
set -eux
shipped=/usr/share/softfinger

cd examples/c_program
make
./touch sphere | grep -q 'joints'
./press index
# Until Ctrl-C, which leads the device away from the finger; a slow machine has it open by then.
timeout --signal=INT 15 ./live plane 7 | grep -q '^state'
cd ../..

cmake -S examples/own_program -B own_program_build -DCMAKE_BUILD_TYPE=Release
cmake --build own_program_build
own_program_build/own_program $shipped/scenes/sphere.toml | grep -q joints

cd examples/python_program
python3 touch.py sphere | grep -q joints
python3 record_and_replay.py plane | grep -q 'every bit the same'
python3 compare_devices.py plane index membrane plate-2dof
python3 lift_a_cup.py cup
printf '0.0 0 0 9.5 1 0 0 0\n0.1 0 0 6.5 1 0 0 0\n' | python3 own_tracker.py plane thimble-3rrs | grep -q ' s  '
cd ../..

cat >run_notebook.py <<'END'
import json, matplotlib, sys
matplotlib.use("Agg")
names = {}
for cell in json.load(open(sys.argv[1]))["cells"]:
    if cell["cell_type"] == "code":
        exec("".join(cell["source"]), names)
END
for notebook in examples/notebooks/*.ipynb; do python3 run_notebook.py $notebook; done

# Clients of a running softfinger: the first prints until it ends, the second moves its finger.
softfinger run plane --repeat --no-twin --port 8123 >run.log &
until grep -q http run.log; do sleep 0.1; done
mcs -langversion:7.2 -unsafe -out:Contact.exe -recurse:'clients/csharp/src/*.cs' clients/csharp/examples/Contact.cs
timeout 10 mono Contact.exe http://127.0.0.1:8123 >contact.log || true
kill $!
wait $! || true
test "$(grep -c ' s  .* N' contact.log)" -gt 60

softfinger run plane --tracker page --no-twin --port 8124 >run.log &
until grep -q http run.log; do sleep 0.1; done
cd examples/javascript_program
# What `npm install` does, with Debian's package of the client's one dependency.
mkdir -p node_modules ../../clients/javascript/node_modules
ln -sfn ../../../clients/javascript node_modules/softfinger-client
ln -sfn /usr/share/nodejs/ws ../../clients/javascript/node_modules/ws
node touch.js http://127.0.0.1:8124 | tail -n 1
kill $!
wait $! || true
