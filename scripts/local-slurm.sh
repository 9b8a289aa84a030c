#!/usr/bin/env bash
# Runs a command on a Slurm cluster that lives as long as the command: a controller and three nodes on this machine,
# status by squeue, no accounting.
#   scripts/local-slurm.sh COMMAND [ARGUMENT...]
# The daemons run in namespaces of their own: they end with the command however it ends, and the slurm.conf and the
# munge key that they see are seen by nobody else; files in /etc/slurm stay as they are.
# A node is a process namespace: `kill -9 $(cat $CRUMPLE_SLURM/n2.pid)` ends all that runs on it, as a power cut does.
# Missing packages are installed (Debian, root). Where there can be no Slurm it says SKIPPED and ends with 0.
set -euo pipefail

skip() { echo "SKIPPED: ${CRUMPLE_SLURM_FOR:-no local Slurm}: $*" >&2; exit 0; }

if [ "${1:-}" != --inside ]; then
    [ $# -gt 0 ] || { echo "usage: scripts/local-slurm.sh COMMAND [ARGUMENT...]" >&2; exit 2; }
    [ "$(id -u)" -eq 0 ] || skip "needs root"
    programs="slurmctld slurmd munged sbatch squeue"
    # shellcheck disable=SC2086 # one word a program
    if ! command -v $programs >/dev/null; then
        command -v apt-get >/dev/null || skip "no Slurm here, and no apt-get to install it"
        # RUNLEVEL=1: the installed daemons are not started, they have no configuration.
        { apt-get update -qq && RUNLEVEL=1 DEBIAN_FRONTEND=noninteractive \
            apt-get install -y -qq --no-install-recommends slurmctld slurmd slurm-client munge; } >&2 ||
            skip "Slurm cannot be installed"
    fi
    unshare --mount --pid --fork --kill-child --mount-proc true || skip "no namespaces here"
    folder=$(mktemp -d /tmp/crumple-slurm.XXXXXX)
    trap 'rm -rf "$folder"' EXIT
    status=0
    unshare --mount --pid --fork --kill-child --mount-proc "$0" --inside "$folder" "$@" || status=$?
    exit "$status"
fi

folder=$2
shift 2
host=$(hostname)
# munged refuses a socket below a folder that others cannot enter.
chmod 755 "$folder"
mkdir "$folder"/{etc,state,spool,log}
head -c 128 /dev/urandom >"$folder/munge.key"
chmod 600 "$folder/munge.key"
# Two faked processors a node: what is tested is the cluster, not its speed. A job of a lost node may start again as
# soon as its credential has expired, 120 s by default. srun in a job looks for the file in /etc/slurm alone.
cat >"$folder/etc/slurm.conf" <<CONF
ClusterName=crumple
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=26817
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket,cred_expire=10
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool/%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/%n-slurmd.pid
SlurmctldLogFile=$folder/log/slurmctld.log
SlurmdLogFile=$folder/log/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc=$folder/log/jobs.txt
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SlurmdParameters=config_overrides
SlurmdTimeout=12
ReturnToService=2
EnforcePartLimits=ALL
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=26821 CPUs=2 RealMemory=4000
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=26822 CPUs=2 RealMemory=4000
NodeName=n3 NodeHostname=$host NodeAddr=127.0.0.1 Port=26823 CPUs=2 RealMemory=4000
PartitionName=main Nodes=ALL Default=YES MaxTime=60
CONF
mkdir -p /etc/slurm
mount --bind "$folder/etc" /etc/slurm
unset SLURM_CONF
export CRUMPLE_SLURM="$folder"

say_logs() { tail -n 20 "$folder"/log/*.log >&2; }
munged --foreground --key-file "$folder/munge.key" --socket "$folder/munge.socket" --pid-file "$folder/munged.pid" \
    --log-file "$folder/log/munged.log" --seed-file "$folder/munge.seed" >/dev/null 2>&1 &
for _ in $(seq 100); do [ -S "$folder/munge.socket" ] && break; sleep 0.1; done
slurmctld -D >/dev/null 2>&1 &
for node in n1 n2 n3; do
    # A shell is the first process of a node: it takes the dead off the list of processes.
    unshare --mount --pid --fork --kill-child --mount-proc sh -c "slurmd -D -N $node; true" >/dev/null 2>&1 &
    echo $! >"$folder/$node.pid"
done
for _ in $(seq 300); do
    [ "$(sinfo --noheader --Node --format %t 2>/dev/null | grep -c idle)" -eq 3 ] && break
    sleep 0.2
done
[ "$(sinfo --noheader --Node --format %t | grep -c idle)" -eq 3 ] || { say_logs; exit 1; }

status=0
"$@" || status=$?
[ "$status" -eq 0 ] || say_logs
exit "$status"
