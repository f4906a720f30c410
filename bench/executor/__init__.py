"""Independent pieces of work, one after the other or side by side: in threads, in processes, on a cluster.

An executor is an argument of what uses it (`diagnose(..., executor=...)`), never a setting of the process. Results do
not depend on it. Inside a worker every executor works serially, so functions may hand theirs on without a thought.
"""
