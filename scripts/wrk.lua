-- wrk.lua: script of wrk for scripts/load and scripts/large: sends the requests of a list.
-- Arguments: the list, a line for each request: its path, and the file of its body; the files' media type; a
-- token; what a good response has, a pattern; "once", or "again": from the first one, until wrk ends; and the
-- time in ms that a connection waits before each request, 0: none.
-- One thread only.  Prints one line at the end:
--   requests seconds p50 p95 p99 good busy lost
-- Times in ms; busy: responses with 503; lost: all other requests.
local requests, sent, seen, once = {}, 0, 0, false
local pattern, worker

good, busy, other = 0, 0, 0 -- global, because done() cannot reach them otherwise

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
    local pause = tonumber(args[6])

    for line in io.lines(args[1]) do
        local path, body = line:match("^(%S+) (%S+)$")

        requests[#requests + 1] = wrk.format("POST", path, {
            ["Authorization"] = "Bearer " .. args[3],
            ["Content-Type"] = args[2],
        }, read(body))
    end
    pattern, once = args[4], args[5] == "once"
    if pause > 0 then
        math.randomseed(1)
        delay = function() -- random, or all connections would send at the same time
            return math.floor(pause * (0.5 + math.random()) + 0.5)
        end
    end
end

function request()
    sent = sent % #requests + 1
    return requests[sent]
end

function response(status, _, body)
    seen = seen + 1
    if body:find(pattern) then
        good = good + 1
    elseif status == 503 then
        busy = busy + 1
    else
        other = other + 1
    end
    if once and seen == #requests then
        wrk.thread:stop()
        -- wrk's main thread sleeps until its time is over or it gets a signal.  Repeated,
        -- because this thread, which is about to end, may get the signal instead.
        io.popen("(for _ in 1 2 3 4 5; do sleep 0.05; kill -INT $PPID || exit; done) 2>&1 &"):close()
    end
end

function done(summary, latency)
    local e = summary.errors

    io.write(string.format("result %d %.3f %.2f %.2f %.2f %d %d %d\n", summary.requests,
        summary.duration / 1e6, latency:percentile(50) / 1e3, latency:percentile(95) / 1e3,
        latency:percentile(99) / 1e3, worker:get("good"), worker:get("busy"),
        worker:get("other") + e.connect + e.read + e.write + e.timeout))
end
