-- large.lua: script of wrk for scripts/large: sends one request for each line of a list, then
-- stops.  Arguments: "verify" or "enroll"; the list, of subjects' numbers; the folder with their
-- scans; a token.  "enroll" enrolls each scan under a new subject id.  One thread only.
-- Prints one line at the end: requests seconds p50 p99 other
-- Times in ms; other: responses that are not a match, or not created, and failed connections.
local wanted = {verify = '"decision":%s*"match"', enroll = '"created":%s*true'}
local requests, sent, seen = {}, 0, 0
local pattern, worker

other = 0 -- global, because done() cannot reach it otherwise

function setup(thread)
    worker = thread
end

local function read(path)
    local file = assert(io.open(path, "rb"))
    local text = file:read("*a")

    file:close()
    return text
end

function init(args)
    local mode, list, folder, token = args[1], args[2], args[3], args[4]
    local run = os.time() .. "-" .. math.random(1e9)

    pattern = wanted[mode]
    for subject in io.lines(list) do
        local path = "/v1/subjects/s" .. subject .. "/verify"

        if mode == "enroll" then
            path = "/v1/subjects/" .. run .. "-" .. subject .. "/templates"
        end
        requests[#requests + 1] = wrk.format("POST", path, {
            ["Authorization"] = "Bearer " .. token,
            ["Content-Type"] = "model/x-ply",
        }, read(folder .. "/" .. subject .. ".ply"))
    end
end

function request()
    sent = sent % #requests + 1
    return requests[sent]
end

function response(_, _, body)
    seen = seen + 1
    if not body:find(pattern) then
        other = other + 1
    end
    if seen == #requests then
        wrk.thread:stop()
        -- wrk's main thread sleeps until its time is over or it gets a signal.  Repeated,
        -- because this thread, which is about to end, may get the signal instead.
        io.popen("(for _ in 1 2 3 4 5; do sleep 0.05; kill -INT $PPID || exit; done) 2>&1 &"):close()
    end
end

function done(summary, latency)
    local e = summary.errors

    io.write(string.format("result %d %.3f %.2f %.2f %d\n", summary.requests,
        summary.duration / 1e6, latency:percentile(50) / 1e3, latency:percentile(99) / 1e3,
        worker:get("other") + e.connect + e.read + e.write + e.timeout))
end
