#!/usr/bin/env bash
# tests/package/package_abi.sh - `script TOOL BUILD SOURCE`: programs that are
# linked already go on working (scripts/abi).
exec python3 -B "$3/scripts/abi"
