# Runs the example in a folder of its own, as ./demo does in the checkout: run_job.sh SIMULATE_HITS ROBOMILL SOURCE FOLDER
simulate_hits=$1 robomill=$2 source=$3 folder=$4
rm -rf "$folder"
mkdir -p "$folder/examples/first-lobes" "$folder/data"
cp "$source"/*.toml "$folder/examples/first-lobes"
cp "$source"/../../data/*.toml "$folder/data"
cd "$folder/examples/first-lobes"
"$simulate_hits" hits
"$robomill" plan job.toml -o out
test -s out/report.html
