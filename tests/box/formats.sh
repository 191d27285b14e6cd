#!/bin/sh
# The same scan in every format that is read, and in its dialects: the daemon and the command
# match it, as what it is declared to be and by its content; what is not read is refused by
# its name, with the list of what is.
. tests/box/lib.sh
needs python3
scan 1 0 "$T/a.ply"
scan 1 1 "$T/again.ply"
"$BUILD/surfacelab" simplify "$T/again.ply" --tolerance 0.0005 -o "$T/mesh.ply" >"$T/text"
mkdir "$T/in"
python3 tests/box/formats.py "$T/mesh.ply" "$T/in" || exit 1
start_daemon --no-auth --attempts 0
gives 201 "enrolled" send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
camera='fx=600&fy=600&cx=119.5&cy=159.5&depth_scale='

# ---- over HTTP
send POST /v1/subjects/alice/verify "$BYTES" "$T/in/ascii.ply"
score=$(get .score)
for file in "$T"/in/*.*; do
    name=${file##*/} query=''
    case $name in
    *.ply*) type=model/ply ;;
    *.obj) type=model/obj ;;
    *.stl*) type=model/stl ;;
    *.pcd) type=application/x-pcd ;;
    *.glb*) type=model/gltf-binary ;;
    *.csv*) type=text/csv ;;
    *.json*) type=application/json ;;
    *.wrl*) type=model/vrml ;;
    *.png) type=image/png query="?${camera}10000" ;;
    *.pgm) type=image/x-portable-graymap query="?${camera}10000" ;;
    *.raw) type=text/plain query="?${camera}10000&width=240&height=320" ;;
    depth.npy | floats.npy) type=text/plain query="?${camera}10000" ;;
    *) type=text/plain ;;
    esac
    for type in application/octet-stream $type; do
        send POST "/v1/subjects/alice/verify$query" "Content-Type: $type" "$file"
        is "$name as $type" "$STATUS $(get .decision)" "200 match"
        case $name in
        *.png | *.pgm | *.raw | *.abs* | depth.npy | floats.npy | image.npy) ;; # other points of
                                                                               # the same surface
        *) ok "$name as $type: the same digits, nearly" \
            jq_true "(.score - $score) | fabs < 1" "$T/body" ;;
        esac
    done
done

# ---- the command
ctl enroll alice "$T/a.ply"
for file in "$T"/in/*.*; do
    case $file in *.raw) size=,240,320 ;; *) size='' ;; esac
    ctl_exits 0 verify alice "$file" --camera "600,600,119.5,159.5,10000$size"
done
"$BUILD/surfacectl" --db "$DB" verify alice - <"$T/in/binary.stl" >"$T/text"
is "from standard input" "$?" 0
mkdir "$T/folder"
for name in ascii.ply faces.obj binary.stl ascii.pcd metres.glb time.csv count.pts blanks.xyz \
    points.json depth.png mesh.ply.gz new.wrl grid.bnt range.abs.gz fortran.npy five.pgm; do
    cp "$T/in/$name" "$T/folder/${name%%.*}_1.${name#*.}"
done
ctl_exits 0 enroll "$T/folder" --camera 600,600,119.5,159.5,10000
is "a folder of all of them" "$(said '[.scans, .enrolled, .present, .failed, .left_out] | @csv')" \
    '16,15,1,0,0'

# ---- the scale of a depth image, and its camera
send POST /v1/subjects/alice/verify 'Content-Type: image/png' "$T/in/depth.png"
problem "without a camera" 400 malformed 'fx, fy, cx and cy'
send POST "/v1/subjects/alice/verify?fx=600&fy=600&cx=119" "$BYTES" "$T/in/depth.png"
problem "without cy" 400 malformed 'fx, fy, cx and cy'
send POST "/v1/subjects/alice/verify?${camera}10000&width=320&height=241" "$BYTES" "$T/in/values.raw"
problem "of another size" 400 malformed '320 x 241 pixels of 16 bits take 154240 bytes'
send POST "/v1/subjects/alice/verify?${camera}10000&width=240&height=320" 'Content-Type: image/png' \
    "$T/in/depth.png"
is "PNG that says so" "$STATUS $(get .scan.format)" "200 png"
for unit in auto m; do
    send POST "/v1/subjects/alice/verify?${camera%&*}&units=$unit" "$BYTES" "$T/in/metres/depth.npy"
    is "floats without a scale, in $unit" "$STATUS $(get .scan.units)" "200 m"
done
for camera in 600 600,600,1 600,600,1,2,3,4 600,600,1,2,3,4,5,6 600,600,1,2,3,0,5 600,600,1,2,3,4,1.5 0,600,1,2 600,600,1,2,0 600,600,1,x '600,600,1,2,' ''; do
    ctl_exits 64 verify alice "$T/in/depth.png" --camera "$camera"
done
ctl_exits 65 verify alice "$T/in/depth.png"
ok "what is missing" grep -q 'fx, fy, cx and cy' "$T/ctl.err"

# ---- a unit of the request, against that of a GLB file's format
send POST '/v1/subjects/alice/verify?units=mm' "$BYTES" "$T/in/metres.glb"
problem "a GLB said to be in mm" 422 units_suspicious
send POST '/v1/subjects/alice/verify?units=mm' "$BYTES" "$T/in/inch.csv"
is "a unit in the heading" "$STATUS $(get .decision)" "200 match"

# ---- points without a value are not the heat map's
send POST '/v1/subjects/alice/verify?detail=heatmap' "$BYTES" "$T/in/nan.ply"
is "the heat map: the points that were sent" "$(get '.heatmap | length')" \
    "$(sed -n 's/element vertex //p' "$T/in/nan.ply")"
is "null where there is none" \
    "$(get '.heatmap | .[:40] + .[-40:] | all(. == null)')" true
is "but not elsewhere" "$(get '.heatmap[40:-40] | map(select(. != null)) | length > 2500')" true

# ---- refused by name
for file in "$T"/in/bad/*; do
    name=${file##*/}
    case $name in bits) words='of 8 bits: a depth image has 16' ;; *) words="$name" ;; esac
    send POST /v1/subjects/alice/verify "$BYTES" "$file"
    problem "$name" 400 malformed "$words"
    ctl_exits 65 verify alice "$file"
    ok "$name, the command" grep -q "$words" "$T/ctl.err"
    [ "$name" = bits ] || ok "$name: what is read" grep -q 'PLY, OBJ, STL, PCD, GLB' "$T/ctl.err"
done
finish
