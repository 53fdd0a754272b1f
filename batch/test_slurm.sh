#!/usr/bin/env bash
# Tries the Slurm profile against a real cluster of this machine's own: munged, slurmctld and two slurmd, each with a
# configuration, a key, ports and folders of its own below a temporary one, and ended afterwards.
#
#   sudo apt-get install slurm-wlm munge snakemake; sudo batch/test_slurm.sh [CLIPGS]
#
# Small phantoms go through; a node is drained, a job is cancelled and another's process killed in the middle, one asks
# for more memory than there is, and Snakemake itself is killed and run again. The cases must have the bytes of those
# built one by one. As root, some three minutes on two cores.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
clipgs="$(realpath "${1:-$here/../build/release/src/cli/clipgs}")"
export SOURCE_DATE_EPOCH=1700000000
export PYTHONDONTWRITEBYTECODE=1

fail() {
  echo "test_slurm: $*" >&2
  exit 1
}
[ "$(id -u)" -eq 0 ] || fail "needs root: slurmd runs jobs as those who submit them"
for program in munged slurmctld slurmd sbatch snakemake; do
  command -v "$program" >/dev/null || PATH="$PATH:/usr/sbin"
  command -v "$program" >/dev/null || fail "there is no $program; apt-get install slurm-wlm munge snakemake"
done

work="$(mktemp -d /tmp/clipgs-slurm.XXXXXX)"
chmod 755 "$work" # munge asks for it
pids=()
clean_up() {
  local status=$? pid
  if [ "$status" -ne 0 ]; then
    tail -n 30 "$work"/*.log 2>/dev/null || true
  fi
  scancel --user=root >/dev/null 2>&1 || true
  sleep 1
  for pid in $(tac -s' ' <<<"${pids[*]} "); do
    kill "$pid" 2>/dev/null || true
  done
  for pid in "${pids[@]}"; do
    wait "$pid" 2>/dev/null || true
  done
  rm -rf "$work"
  exit "$status"
}
trap clean_up EXIT
trap 'exit 130' INT TERM

# A port that is free now.
port() {
  python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

start_cluster() {
  local host user=root
  host="$(hostname -s)"
  mkdir -m 755 "$work/munge" "$work/state" "$work/one" "$work/two"
  dd if=/dev/urandom of="$work/munge/key" bs=1024 count=1 status=none
  chmod 400 "$work/munge/key"
  munged --foreground --force --key-file="$work/munge/key" --socket="$work/munge/socket" --pid-file="$work/munge/pid" \
    --log-file="$work/munge.log" --seed-file="$work/munge/seed" >"$work/munged.log" 2>&1 &
  pids+=($!)
  cat >"$work/slurm.conf" <<END
ClusterName=clipgs
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$user
SlurmctldPort=$(port)
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
ReturnToService=2
SchedulerParameters=sched_interval=1,batch_sched_delay=0,defer
KillWait=2
NodeName=one NodeHostname=$host NodeAddr=127.0.0.1 Port=$(port) CPUs=1 RealMemory=3000
NodeName=two NodeHostname=$host NodeAddr=127.0.0.1 Port=$(port) CPUs=1 RealMemory=3000
PartitionName=all Nodes=one,two Default=YES MaxTime=INFINITE State=UP
END
  export SLURM_CONF="$work/slurm.conf"
  sleep 1
  slurmctld -D -i >"$work/slurmctld.log" 2>&1 &
  pids+=($!)
  slurmd -D -N one >"$work/slurmd.one.log" 2>&1 &
  pids+=($!)
  slurmd -D -N two >"$work/slurmd.two.log" 2>&1 &
  pids+=($!)
  local i
  for i in $(seq 60); do
    [ "$(sinfo -h -t idle -o %D 2>/dev/null)" = 2 ] && return
    sleep 0.5
  done
  fail "the cluster did not come up"
}

# batch CSV OUT [WORD...]: as docs/batch.md has it.
batch() {
  local cases="$1" out="$2"
  shift 2
  snakemake -s "$here/Snakefile" --profile "$here/profiles/slurm" --latency-wait 5 --configfile "$work/tiny.yaml" \
    --config "cases=$cases" "out=$out" steps=apart "$@" >>"$work/snakemake.log" 2>&1
}

# until_running NAME: the number of a job whose name is like that, when it runs.
until_running() {
  local i number
  for i in $(seq 300); do
    number="$(squeue -h -t R -o '%i %j' | awk -v name="$1" '$2 ~ name {print $1; exit}')"
    if [ -n "$number" ]; then
      echo "$number"
      return
    fi
    sleep 0.1
  done
  fail "no job like $1 ever ran"
}

start_cluster
echo "test_slurm: a cluster of two nodes is up"

mkdir "$work/data"
{
  echo "name,volume,title,model,test-size"
  for i in 1 2 3 4 5; do
    "$clipgs" phantom "$work/data/$i.nrrd" --size 32 --seed "$i" >/dev/null
    echo "case$i,$i.nrrd,Case $i,,"
  done
  echo "papers,1.nrrd,Papers,clipgs,"
  echo "broken,broken.nrrd,,,"
} >"$work/data/cases.csv"
head -c 2000 "$work/data/1.nrrd" >"$work/data/broken.nrrd"
# A header of 1500 x 1500 x 1500 voxels; what it needs is more than a node has.
printf 'ObjectType = Image\nNDims = 3\nDimSize = 1500 1500 1500\nElementType = MET_SHORT\nElementDataFile = none.raw\n' >"$work/data/huge.mhd"
echo "huge,huge.mhd,,," >>"$work/data/cases.csv"
cat >"$work/tiny.yaml" <<END
clipgs: $clipgs
threads: 1
options: {quality: draft, size: 64, train-frames: 60, test-frames: 1, uncut-frames: 1, budget: 3000, steps: 1500}
END

batch "$work/data/cases.csv" "$work/out" 2>/dev/null &
main=$!
number="$(until_running 'case[12][.]train')"
scontrol update NodeName=two State=DRAIN Reason=test
scancel "$number"
echo "test_slurm: drained a node, cancelled a job that trained"
victim=
for _ in $(seq 600); do
  victim="$(pgrep -f "^$clipgs .* train case" | head -n 1 || true)"
  [ -z "$victim" ] || break
  sleep 0.1
done
sleep 1
kill -9 "$victim"
echo "test_slurm: killed a process that trained"
until_running 'case[1-5][.]' >/dev/null
pkill -9 -P "$main" # Snakemake, which the function runs
wait "$main" 2>/dev/null || true # its shell says that it was killed
echo "test_slurm: killed Snakemake; its jobs go on"
scontrol update NodeName=two State=RESUME
if batch "$work/data/cases.csv" "$work/out"; then
  fail "a batch with a broken and a huge case must not end well"
fi

grep -qx 'huge: dataset: Slurm refuses a job of [0-9]* MB, 1 threads: .*' "$work/snakemake.log" ||
  fail "what is too large for the cluster is not said in one line"
grep -q '^broken: dataset: clipgs: ' "$work/snakemake.log" "$work"/out/broken.clipgs-work/batch/slurm.log ||
  fail "what is broken is not said in one line"
echo "test_slurm: a job that no node has the memory for, and a broken volume: one line each"

for i in 1 2 3 4 5; do
  "$clipgs" --quiet build "$work/data/$i.nrrd" -o "$work/case$i.sog" --title "Case $i" --quality draft --size 64 \
    --train-frames 60 --test-frames 1 --uncut-frames 1 --budget 3000 --steps 1500 >/dev/null 2>&1
  cmp "$work/case$i.sog" "$work/out/case$i.sog" || fail "case$i has other bytes than built alone"
  [ -s "$work/out/case$i.figures" ] || fail "case$i was not measured"
done
echo "test_slurm: five cases have the bytes of those built one by one"
[ -s "$work/out/papers.figures" ] || fail "the papers' way did not come through"
[ -s "$work/out/overview/index.html" ] || fail "there is no overview"
for name in huge broken; do
  grep -q "data-name=\"$name\" data-kind=\"failed" "$work/out/overview/index.html" ||
    fail "the overview does not name $name"
done
echo "test_slurm: passed in $SECONDS s"
