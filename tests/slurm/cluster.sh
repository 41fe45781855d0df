# Sourced: a Slurm cluster of two nodes on this machine, below the folder $cluster. Start it with start_cluster, end it with
# stop_cluster. Needs Debian's munge, slurmctld, slurmd and slurm-client, all started by this user.

need_slurm() {
  local program
  export PATH="$PATH:/usr/sbin"
  for program in munged slurmctld slurmd sbatch squeue scontrol; do
    command -v "$program" >/dev/null || { echo "skipped: $program is not installed (Debian packages munge slurmctld slurmd slurm-client)"; exit 77; }
  done
}

# free_ports N: a first port of N that nobody listens on, in a range of this process.
first_port() {
  echo $((20000 + ($$ % 4000) * 10))
}

start_cluster() {
  mkdir -p "$cluster"/{state,spool,munge}
  chmod 700 "$cluster/munge" "$cluster"
  local port user
  port=$(first_port)
  user=$(id -un)
  head -c 128 /dev/urandom >"$cluster/munge/key"
  chmod 400 "$cluster/munge/key"
  if ! munged --key-file="$cluster/munge/key" --socket="$cluster/munge/socket" --pid-file="$cluster/munge/pid" \
    --log-file="$cluster/munge/log" --seed-file="$cluster/munge/seed" --force; then
    echo "skipped: munged does not start on this machine"
    exit 77
  fi
  cat >"$cluster/slurm.conf" <<EOF
ClusterName=alidade
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$port
AuthType=auth/munge
AuthInfo=socket=$cluster/munge/socket,cred_expire=5
CredType=cred/munge
SlurmUser=$user
SlurmdUser=$user
StateSaveLocation=$cluster/state
SlurmdSpoolDir=$cluster/spool/%n
SlurmctldPidFile=$cluster/slurmctld.pid
SlurmdPidFile=$cluster/%n.pid
SlurmctldLogFile=$cluster/slurmctld.log
SlurmdLogFile=$cluster/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdTimeout=5
SlurmctldTimeout=5
ReturnToService=2
SchedulerParameters=sched_interval=1,sched_min_interval=0,bf_interval=1
MinJobAge=60
NodeName=node1 NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1 State=UNKNOWN
NodeName=node2 NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1 State=UNKNOWN
PartitionName=all Nodes=node1,node2 Default=YES MaxTime=INFINITE State=UP
EOF
  export SLURM_CONF=$cluster/slurm.conf
  slurmctld -c || true
  start_node node1 || true
  start_node node2 || true
  local i
  for i in $(seq 60); do
    [[ "$(sinfo --noheader --format=%D/%t 2>/dev/null | tr -d ' ')" == 2/idle ]] && return
    sleep 0.5
  done
  sinfo || true
  tail --lines=5 "$cluster"/*.log
  echo "skipped: Slurm's daemons do not come up on this machine"
  exit 77
}

start_node() {
  mkdir -p "$cluster/spool/$1"
  slurmd -N "$1"
}

# Ends the daemon of a node and all that it runs, as when the machine fails, if it runs a task: all are stopped first, and live on when
# the program is not among them, since a task that has ended is not requeued. Prints the number of processes ended.
kill_busy_node() {
  local victims environment process parent busy=false
  victims=("$(cat "$cluster/$1.pid")")
  for environment in $(grep --files-with-matches --null-data --no-messages "^SLURMD_NODENAME=$1$" /proc/[0-9]*/environ); do
    process=${environment#/proc/}
    process=${process%/environ}
    parent=$(sed 's/.*) [A-Z] \([0-9]*\) .*/\1/' "/proc/$process/stat" 2>/dev/null) || continue
    victims+=("$process")
    if [[ "$(cat "/proc/$parent/comm" 2>/dev/null)" == slurmstepd* ]]; then
      victims+=("$parent")
    fi
  done
  kill -STOP "${victims[@]}" 2>/dev/null || true
  for process in "${victims[@]}"; do
    grep --quiet --no-messages '^[0-9]* (alidade) T' "/proc/$process/stat" && busy=true
  done
  if ! $busy; then
    kill -CONT "${victims[@]}" 2>/dev/null || true
    echo 0
    return
  fi
  kill -9 "${victims[@]}" 2>/dev/null || true
  rm -f "$cluster/$1.pid"
  echo "${#victims[@]}"
}

stop_cluster() {
  local file
  for file in node1.pid node2.pid slurmctld.pid munge/pid; do
    [[ -e "$cluster/$file" ]] && kill "$(cat "$cluster/$file")" 2>/dev/null || true
  done
}
